"""The paper's printed figures, put beside the rows that they belong to."""

from importlib.resources import files
from typing import Any

import yaml

from physpipe.report.evidence import Evidence, Row

PAPER = "paper_"


def tracker_rows(evidence: Evidence) -> dict[str, Row]:
    """Tracker to its scores, with `paper_*` beside those that the paper's table holds."""
    return _beside(evidence.trackers, _printed("trackers", evidence))


def predictor_rows(evidence: Evidence) -> dict[str, dict[str, Row]]:
    """Supervision to predictor to its scores, with `paper_*` beside those that the paper's tables hold."""
    printed = _printed("predictors", evidence)
    return {each: _beside(rows, printed.get(each, {})) for each, rows in evidence.predictors.items()}


def calibration_row(evidence: Evidence) -> Row:
    """Errors of polynomials, which say how hard the motion is, with the paper's and the ratio of ours to it."""
    printed = _printed("predictors", evidence).get("truth", {})
    row = dict(evidence.calibration)
    for name in ("linear", "quadratic"):
        for horizon in ("T", "2T"):
            ours, paper = row.get(f"{name}_{horizon}_px"), printed.get(name, {}).get(f"error_{horizon}_px")
            if ours is not None and paper is not None:
                row |= {f"{PAPER}{name}_{horizon}_px": paper, f"ratio_{name}_{horizon}": ours / paper}
    return row


def _beside(rows: dict[str, Row], printed: dict[str, Row]) -> dict[str, Row]:
    return {
        name: {**row, **{PAPER + key: value for key, value in printed.get(name, {}).items()}}
        for name, row in rows.items()
    }


def _printed(what: str, evidence: Evidence) -> dict[str, Any]:
    """The paper's `trackers` or `predictors` of this data set, or of the real one that it stands in for."""
    tables = _paper()
    found: dict[str, Any] = tables[what].get(tables["stand_ins"].get(evidence.name, evidence.name), {})
    return found


def _paper() -> dict[str, Any]:
    return yaml.safe_load(files("physpipe.report").joinpath("paper.yaml").read_text())
