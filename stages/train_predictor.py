"""Fit one predictor to the tracks (or the truth) of the training clips."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.horizon import PredictParams
from physpipe.core.params import read, read_value
from physpipe.io import tracks
from physpipe.io.checkpoints import forget, scratch
from physpipe.io.clips import ClipSet
from physpipe.predictor_learning.predicting import learn_predictor, learned_params, predictor_class, save_predictor


def main(name: str, predictor: str, clips: Path, found: Path, out: Path) -> None:
    """Writes `weights.pt` and `curve.csv` to the folder `out`; data set `name` says how far to forecast."""
    predict, compute = read(f"datasets.{name}.predict", PredictParams), read("compute", ComputeParams)
    kind = predictor_class(read_value(f"predictors.{predictor}.kind"))
    params = read(f"predictors.{predictor}", learned_params(kind)).on(predict)
    last_frame = predict.last_frame(params.trained_to, f"datasets.{name}.predict")
    prepare(compute)
    folder = scratch("train_predictor", [predict, compute, params], [clips, found])
    film, table, checkpoint = ClipSet(clips), tracks.load(found), folder / "training.pt"
    learned, curve = learn_predictor(
        predictor, params, film, table, last_frame, predict.mirrors, compute.seed, checkpoint
    )
    save_predictor(out, predictor, learned, params, curve)
    forget(folder)


if __name__ == "__main__":
    run(main)
