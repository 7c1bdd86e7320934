"""Fit one predictor to the tracks (or the truth) of the training clips."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io import tracks
from physpipe.io.checkpoints import forget, scratch
from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams
from physpipe.predictor_learning.predicting import learn_predictor, predictor_class, save_predictor
from physpipe.predictor_learning.windows import WindowParams
from physpipe.predictors.horizon import PredictParams


def main(name: str, predictor: str, clips: Path, found: Path, out: Path) -> None:
    """Writes `weights.pt` and `curve.csv` to the folder `out`; data set `name` says how far to forecast."""
    predict, compute = read(f"datasets.{name}.predict", PredictParams), read("compute", ComputeParams)
    model = read(f"predictors.{predictor}.model", predictor_class(predictor).Params)
    fit = read(f"predictors.{predictor}.fit", FitParams)
    windows = read(f"predictors.{predictor}.windows", WindowParams)
    prepare(compute)
    folder = scratch("train_predictor", [predict, compute, model, fit, windows], [clips, found])
    learned, curve = learn_predictor(
        predictor,
        (model, fit, windows),
        ClipSet(clips),
        tracks.load(found),
        predict.horizon,
        compute.seed,
        folder / "training.pt",
    )
    save_predictor(out, predictor, learned, model, curve)
    forget(folder)


if __name__ == "__main__":
    run(main)
