"""Errors of the tracker and the predictor that were tuned together, test split only."""

from pathlib import Path

from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.horizon import PredictParams
from physpipe.core.params import read
from physpipe.io import forecasts, results, tracks
from physpipe.io.clips import ClipSet
from physpipe.scoring.predictors import EvaluatePredictorsParams, score_predictors
from physpipe.scoring.trackers import EvaluateTrackersParams, score_trackers


def main(name: str, predictor: str, clips: Path, truth: Path, tuned: Path, persistence: Path, out: Path) -> None:
    """Writes `trackers`, `predictors` and `gate`, the verdict on whether tuning gained, to `out`."""
    predict, ball = read(f"datasets.{name}.predict", PredictParams), read(f"datasets.{name}.evaluate", BallParams)
    of_trackers = read("evaluate_trackers", EvaluateTrackersParams)
    of_predictors = read("evaluate_predictors", EvaluatePredictorsParams)
    film, annotated = ClipSet(clips), tracks.load(truth)
    files = {f"unsupervised_with_{predictor}": "tracks", f"unsupervised_unrefined_with_{predictor}": "unrefined"}
    found = {row: tracks.load(tuned / f"{file}.parquet") for row, file in files.items()}
    verdict = results.load_json(tuned / "models" / "verdict.json")
    followed, _ = score_trackers(film, annotated, found, dict.fromkeys(found, verdict), of_trackers, ball)
    tables = {"persistence": forecasts.load(persistence), predictor: forecasts.load(tuned / "forecast.parquet")}
    forecast, _ = score_predictors(
        film, annotated, {"tuned": tables}, predict.horizon, of_predictors, ball, simulated=None
    )
    rows = {"trackers": followed, "predictors": {predictor: forecast["tuned"][predictor]}}
    results.save_json(out, {**rows, "gate": verdict})


if __name__ == "__main__":
    run(main)
