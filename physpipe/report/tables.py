"""The metrics files: what `dvc metrics` and `dvc plots` read, and what Git keeps."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.io import results
from physpipe.report.curves import error_distributions
from physpipe.report.paper import calibration_row, predictor_rows, tracker_rows
from physpipe.report.run import Evidence

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
        {each.name: {**predictor_rows(each), "calibration": calibration_row(each)} for each in every},
    )
    results.save_json(folder / "summary.json", summary(every, predictor))
    results.save_csv(folder / "curves.csv", _long([each.horizons for each in every], every, CURVE_COLUMNS))
    distributions = [error_distributions(each.tracker_errors) for each in every]
    results.save_csv(folder / "tracker_errors.csv", _long(distributions, every, DISTRIBUTION_COLUMNS))
    results.save_csv(folder / "learning.csv", _long([each.learning for each in every], every, LEARNING_COLUMNS))


def summary(every: Sequence[Evidence], predictor: str) -> dict[str, Any]:
    """Headline figures, `<data set>_<figure>` to a number or a truth value; what is not known is left out."""
    figures = {f"{each.name}_{key}": value for each in every for key, value in _headlines(each, predictor)}
    return {key: value for key, value in figures.items() if value is not None}


def _headlines(evidence: Evidence, predictor: str) -> Iterator[tuple[str, Any]]:
    yield "locked", evidence.locked
    ours = evidence.trackers.get("unsupervised", {})
    for key in ("mean_px", "median_px", "p99_px", "off_track", "swaps"):
        yield f"unsupervised_{key}", ours.get(key)
    for supervision, rows in evidence.predictors.items():
        for name in dict.fromkeys((predictor, "persistence")):
            for key in ("error_T_px", "error_2T_px"):
                yield f"{name}_{supervision}_{key}", rows[name].get(key)
    for key, value in calibration_row(evidence).items():
        if key.startswith("ratio"):
            yield f"calibration_{key}", value


def _long(parts: Sequence[pd.DataFrame], every: Sequence[Evidence], columns: list[str]) -> pd.DataFrame:
    named = [part.assign(dataset=each.name)[columns] for part, each in zip(parts, every, strict=True)]
    return pd.concat([pd.DataFrame(columns=columns), *named], ignore_index=True)
