"""What ran, and everything that the report shows of it, data set by data set."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.core.params import Section
from physpipe.io import forecasts, results, tracks
from physpipe.io.clips import ClipSet
from physpipe.predictors import BASELINES
from physpipe.report.curves import learning_curves

SUPERVISIONS = ("tracks", "truth")
Row = dict[str, Any]


class RunParams(Section):
    """What this run consists of; files of other runs may lie beside its own and are not looked at."""

    datasets: list[str]
    """Names of the data sets."""
    simulated: list[str]
    """Those of `datasets` that are simulated rather than filmed."""
    learned: list[str]
    """Predictors trained on the unsupervised tracks."""
    supervised: list[str]
    """Predictors trained on the truth, for the paper's supervised rows."""

    def predictors(self, supervision: str) -> list[str]:
        """Predictors of one supervision, those that learn nothing first."""
        learned = self.learned if supervision == "tracks" else self.supervised
        return [*BASELINES, *(name for name in learned if name not in BASELINES)]


@dataclass(frozen=True)
class Sources:
    """Folders that hold the other stages' outputs, a file or a folder a data set in each."""

    clips: Path
    truth: Path
    tracks: Path
    scores: Path
    forecasts: Path
    trackers: Path
    predictors: Path


@dataclass(frozen=True)
class Evidence:
    """All that the report shows of one data set."""

    name: str
    simulated: bool
    clips: ClipSet
    truth: pd.DataFrame
    """Track table; no rows when nobody annotated the film."""
    track: pd.DataFrame
    """The unsupervised tracker's table."""
    trackers: dict[str, Row]
    """Tracker to its scores."""
    predictors: dict[str, dict[str, Row]]
    """Supervision to predictor to its scores; only the predictors of this run."""
    calibration: Row
    """How hard the motion is, as errors of fitted polynomials; empty unless the truth is exact."""
    tracker_errors: pd.DataFrame
    """Columns tracker, clip, object, frame, error_px."""
    horizons: pd.DataFrame
    """Columns supervision, predictor, frame (0 = first seen), error_px."""
    learning: pd.DataFrame
    """Columns model, step, loss, value."""
    forecast: pd.DataFrame
    """Forecasts of the predictor that the pictures show: clip, object, frame, x, y and perhaps covariances."""
    horizon: int
    """T of those forecasts: the number of frames from the first seen one that predictors are trained for."""
    heat_maps: list[bytes]
    """PNGs of the detectors' heat maps: of every start, then of every object."""
    locked: bool
    """Whether the tracker found an object, by its own unsupervised verdict."""
    signals: list[Row]
    """What that verdict rests on, object by object."""

    @property
    def annotated(self) -> bool:
        """Whether there is any truth to measure errors against."""
        return len(self.truth) > 0


def gather(name: str, run: RunParams, sources: Sources, shown: str) -> Evidence:
    """Reads all about data set `name`; `shown` names the predictor of the pictures. Raises InputError."""
    tracker = sources.trackers / name
    scores = sources.scores / name
    predictors = results.load_json(scores / "predictors.json")
    verdict = results.load_json(tracker / "all" / "verdict.json")
    forecast = sources.forecasts / name / "tracks" / f"{shown}.parquet"
    heat_maps = [tracker / part / "heatmaps.png" for part in ("first", "all")]
    return Evidence(
        name=name,
        simulated=name in run.simulated,
        clips=ClipSet(sources.clips / name),
        truth=tracks.load(sources.truth / f"{name}.parquet"),
        track=tracks.load(sources.tracks / f"{name}.parquet"),
        trackers=results.load_json(scores / "trackers.json"),
        predictors={each: _of_this_run(predictors.get(each, {}), run.predictors(each)) for each in SUPERVISIONS},
        calibration=predictors.get("calibration", {}),
        tracker_errors=results.load_csv(scores / "tracker_errors.csv"),
        horizons=_horizons(results.load_csv(scores / "horizons.csv"), run),
        learning=learning_curves(_curve_files(name, run, sources)),
        forecast=forecasts.load(forecast),
        horizon=int(str(forecasts.metadata(forecast)["horizon"])),
        heat_maps=[path.read_bytes() for path in heat_maps if path.is_file()],
        locked=bool(verdict["locked"]),
        signals=verdict["objects"],
    )


def _of_this_run(rows: dict[str, Row], names: Sequence[str]) -> dict[str, Row]:
    return {name: rows[name] for name in names if name in rows}


def _horizons(table: pd.DataFrame, run: RunParams) -> pd.DataFrame:
    wanted = [(each, name) for each in SUPERVISIONS for name in run.predictors(each)]
    return table[pd.MultiIndex.from_frame(table[["supervision", "predictor"]]).isin(wanted)]


def _curve_files(name: str, run: RunParams, sources: Sources) -> list[tuple[str, Path]]:
    """Models and their learning curves, where they have learned anything on this data set."""
    trackers = [("tracker", sources.trackers / name / part / "curve.csv") for part in ("first", "all")]
    predictors = [
        (f"{predictor}, {supervision}", sources.predictors / name / supervision / predictor / "curve.csv")
        for supervision in SUPERVISIONS
        for predictor in run.predictors(supervision)
    ]
    return [(model, path) for model, path in [*trackers, *predictors] if path.is_file()]
