"""Errors of every predictor against the truth, test split only."""

from pathlib import Path

from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.horizon import BASELINES, PredictParams
from physpipe.core.params import read, read_value
from physpipe.io import forecasts, results, tracks
from physpipe.io.clips import ClipSet
from physpipe.scoring.predictors import EvaluatePredictorsParams, score_predictors


def main(name: str, clips: Path, truth: Path, forecast: Path, out: Path) -> None:
    """Writes figures per supervision and predictor to `out`, and error by horizon to `horizons.csv` beside it."""
    predict = read(f"datasets.{name}.predict", PredictParams)
    ball = read(f"datasets.{name}.evaluate", BallParams)
    params = read("evaluate_predictors", EvaluatePredictorsParams)
    supervisions = ["tracks", "truth"] if name in read_value("run.supervised") else ["tracks"]
    predictors = [*BASELINES, *read_value("run.learned")]
    tables = {
        each: {predictor: forecasts.load(forecast / each / f"{predictor}.parquet") for predictor in predictors}
        for each in supervisions
    }
    exact = name in read_value("run.simulated")
    film, annotated = ClipSet(clips), tracks.load(truth)
    figures, horizons = score_predictors(film, annotated, tables, predict.horizon, params, ball, exact)
    results.save_json(out, figures)
    results.save_csv(out.parent / "horizons.csv", horizons)


if __name__ == "__main__":
    run(main)
