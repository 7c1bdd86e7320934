"""The metrics files: what `dvc metrics` and `dvc plots` read, and what Git keeps."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.io import results
from physpipe.report.curves import error_distributions
from physpipe.report.evidence import Evidence
from physpipe.report.paper import calibration_row, predictor_rows, tracker_rows

CURVE_COLUMNS = ["dataset", "supervision", "predictor", "frame", "error_px"]
DISTRIBUTION_COLUMNS = ["dataset", "tracker", "error_px", "share"]
LEARNING_COLUMNS = ["dataset", "model", "step", "loss", "value"]


def save_metrics(folder: Path, every: Sequence[Evidence], predictor: str) -> None:
    """Writes summary.json, trackers.json, predictors.json, curves.csv, tracker_errors.csv and learning.csv.

    `predictor` is the one whose errors the summary holds.
    """
    results.save_json(folder / "trackers.json", {each.name: tracker_rows(each) for each in every})
    results.save_json(
        folder / "predictors.json",
        {each.name: {**predictor_rows(each), **_about(each)} for each in every},
    )
    results.save_json(folder / "summary.json", summary(every, predictor))
    results.save_csv(folder / "curves.csv", _long([each.horizons for each in every], every, CURVE_COLUMNS))
    distributions = [error_distributions(each.tracker_errors) for each in every]
    results.save_csv(folder / "tracker_errors.csv", _long(distributions, every, DISTRIBUTION_COLUMNS))
    results.save_csv(folder / "learning.csv", _long([each.learning for each in every], every, LEARNING_COLUMNS))


def _about(evidence: Evidence) -> dict[str, Any]:
    """What else stands beside the predictors' rows."""
    tuning = {"tuning": evidence.tuning} if evidence.tuning else {}
    return {"calibration": calibration_row(evidence), **tuning}


def summary(every: Sequence[Evidence], predictor: str) -> dict[str, Any]:
    """The few figures that tell one run from another; those that are not known are left out.

    `locked`: in every data set the tracker found an object. And of each data set, as `<data set>_<figure>`: `track_px`,
    the unsupervised tracker's mean error; `T_px` and `2T_px`, the error of `predictor`, trained on those tracks.
    """
    figures = {f"{each.name}_{key}": value for each in every for key, value in _headlines(each, predictor)}
    known = {key: value for key, value in figures.items() if value is not None}
    return {"locked": all(each.locked for each in every), **known}


def _headlines(evidence: Evidence, predictor: str) -> Iterator[tuple[str, Any]]:
    yield "track_px", evidence.trackers.get("unsupervised", {}).get("mean_px")
    for horizon in ("T", "2T"):
        yield f"{horizon}_px", evidence.predictors["tracks"][predictor].get(f"error_{horizon}_px")


def _long(parts: Sequence[pd.DataFrame], every: Sequence[Evidence], columns: list[str]) -> pd.DataFrame:
    named = [part.assign(dataset=each.name)[columns] for part, each in zip(parts, every, strict=True)]
    return pd.concat([pd.DataFrame(columns=columns), *named], ignore_index=True)
