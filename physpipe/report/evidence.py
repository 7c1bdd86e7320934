"""Everything that the report shows, data set by data set, read from what the other stages left."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io import forecasts, results, tables, tracks
from physpipe.io.clips import ClipSet
from physpipe.report.curves import curve_files, learning_curves
from physpipe.report.run import TUNED, RunParams

Row = dict[str, Any]


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
    """Supervision, or `tuned` together with the tracker, to predictor to its scores; only those of this run."""
    tuning: dict[str, Row]
    """Predictor that was tuned together with the tracker to the verdict on whether both gained."""
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
    forecasts: dict[str, pd.DataFrame]
    """Predictor to such a table, for all that are drawn; all learned from unsupervised tracks."""
    horizon: int
    """T of those forecasts: the number of frames from the first seen one that predictors are trained for."""
    heat_maps: list[bytes]
    """PNGs of heat maps: of the first detector's starts and end, then of every detector; fewer where one is missing."""
    locked: bool
    """Whether the tracker found an object, by its own unsupervised verdict."""
    signals: list[Row]
    """What that verdict rests on, object by object."""

    @property
    def annotated(self) -> bool:
        """Whether there is any truth to measure errors against."""
        return len(self.truth) > 0

    @property
    def probabilistic(self) -> bool:
        """Whether some predictor says how sure it is."""
        return any("cov_xx" in table for table in self.forecasts.values())


def gather(name: str, run: RunParams, sources: Sources, shown: str) -> Evidence:
    """Reads all about data set `name`; `shown` names the predictor of the pictures. Raises InputError."""
    if shown not in run.predictors:
        known = ", ".join(run.predictors)
        raise InputError("report.predictor", f"`{shown}` does not run", f"use one of {known}, or add it to run.learned")
    tracker, scores = sources.trackers / name, sources.scores / name
    verdict = results.load_json(tracker / "all" / "verdict.json")
    folder = sources.forecasts / name / "tracks"
    forecast = folder / f"{shown}.parquet"
    heat_maps = [tracker / part / "heatmaps.png" for part in ("first", "all")]
    supervisions = run.supervisions(name)
    tuned = {each: results.load_json(scores / "finetuned" / f"{each}.json") for each in run.finetuned}
    gained = [found for found in tuned.values() if found["gate"]["gained"]]
    return Evidence(
        name=name,
        simulated=name in run.simulated,
        clips=ClipSet(sources.clips / name),
        truth=tracks.load(sources.truth / f"{name}.parquet"),
        track=tracks.load(sources.tracks / f"{name}.parquet"),
        trackers=results.load_json(scores / "trackers.json") | _merged(gained, "trackers"),
        predictors=_of_this_run(scores / "predictors.json", supervisions, run.predictors)
        | ({TUNED: _merged(gained, "predictors")} if gained else {}),
        tuning={each: found["gate"] for each, found in tuned.items()},
        calibration=results.load_json(scores / "predictors.json")["calibration"],
        tracker_errors=results.load_csv(scores / "tracker_errors.csv"),
        horizons=_horizons(scores / "horizons.csv", supervisions, run.predictors),
        learning=learning_curves(curve_files(tracker, sources.predictors / name, supervisions, run.learned)),
        forecast=forecasts.load(forecast),
        forecasts={each: forecasts.load(folder / f"{each}.parquet") for each in run.drawn},
        horizon=tables.metadata(forecast)["horizon"],
        heat_maps=[path.read_bytes() for path in heat_maps if path.is_file()],
        locked=bool(verdict["locked"]),
        signals=verdict["objects"],
    )


def _merged(gained: Sequence[Row], what: str) -> dict[str, Row]:
    """Rows of the pairs that are better for being tuned; the others' are those of the former two."""
    return {name: row for found in gained for name, row in found[what].items()}


def _of_this_run(path: Path, supervisions: Sequence[str], names: Sequence[str]) -> dict[str, dict[str, Row]]:
    scores = results.load_json(path)
    missing = [f"{each} {name}" for each in supervisions for name in names if name not in scores.get(each, {})]
    if missing:
        raise InputError(path, f"lacks scores of {', '.join(missing)}", "run `dvc repro`, which makes them")
    return {each: {name: scores[each][name] for name in names} for each in supervisions}


def _horizons(path: Path, supervisions: Sequence[str], names: Sequence[str]) -> pd.DataFrame:
    table = results.load_csv(path)
    return table[table["supervision"].isin(supervisions) & table["predictor"].isin(names)]
