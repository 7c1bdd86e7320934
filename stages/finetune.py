"""Tune tracker and predictor together, without labels."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.horizon import PredictParams
from physpipe.core.params import read, read_value
from physpipe.finetuning.saving import save_tuned
from physpipe.finetuning.tuning import FinetuneParams, tune
from physpipe.io import tracks
from physpipe.io.checkpoints import forget, scratch
from physpipe.io.clips import ClipSet
from physpipe.predictor_learning.predicting import learned_params, load_predictor, predictor_class
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.trackers import detectors


def main(name: str, predictor: str, clips: Path, found: Path, trained: Path, model: Path, out: Path) -> None:
    """Writes the two that are to be used, the learning curve and the gate's verdict to the folder `out`."""
    predict, compute = read(f"datasets.{name}.predict", PredictParams), read("compute", ComputeParams)
    params, recipe = read("finetune", FinetuneParams), read("tracker", TrackerParams)
    kind = predictor_class(read_value(f"predictors.{predictor}.kind"))
    learned = read(f"predictors.{predictor}", learned_params(kind)).on(predict)
    prepare(compute)
    folder = scratch("finetune", [predict, compute, params, recipe, learned], [clips, found, trained, model])
    table, nets = tracks.load(found), detectors.load(trained / detectors.WEIGHTS)
    untuned = load_predictor(model, predictor, tracks.object_count(found, table))
    last = predict.last_frame(learned.trained_to, f"datasets.{name}.predict")
    tuned = tune(
        ClipSet(clips), table, nets, untuned, last, predict.mirrors, recipe, learned.windows, params, compute.seed,
        folder / "training.pt",
    )  # fmt: skip
    print(f"{name}, {predictor}: {'better' if tuned.gained else 'not better, the former two stay'}")
    save_tuned(out, tuned, predictor, learned)
    forget(folder)


if __name__ == "__main__":
    run(main)
