"""Errors of every predictor against the truth, test split only."""

from pathlib import Path

from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.horizon import BASELINES, PredictParams
from physpipe.core.params import read, read_value
from physpipe.io import forecasts, results, tracks
from physpipe.io.clips import ClipSet
from physpipe.scenes.presets import PresetsParams, SimulateParams
from physpipe.scoring.energy_drift import Replay, replays
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
    film, annotated = ClipSet(clips), tracks.load(truth)
    simulated = _rolled_again(name, film) if name in read_value("run.simulated") else None
    figures, horizons = score_predictors(film, annotated, tables, predict.horizon, params, ball, simulated)
    results.save_json(out, figures)
    results.save_csv(out.parent / "horizons.csv", horizons)


def _rolled_again(name: str, film: ClipSet) -> dict[str, Replay]:
    chosen = read(f"datasets.{name}.simulate", SimulateParams)
    world = chosen.world(read("presets", PresetsParams), f"datasets.{name}.simulate")
    return replays(world, name, film, film.names("test"))


if __name__ == "__main__":
    run(main)
