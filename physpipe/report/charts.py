"""Curves of a data set as the page's script draws them: each line with its model, colour and points."""

from collections.abc import Iterator, Sequence
from typing import Any

import pandas as pd

from physpipe.core.horizon import BASELINES
from physpipe.report import colours
from physpipe.report.coverage import coverage, coverage_charts
from physpipe.report.curves import error_distributions
from physpipe.report.evidence import Evidence
from physpipe.report.glossary import LOSSES
from physpipe.report.line import Chart, line
from physpipe.report.run import SUPERVISIONS, TUNED

STEEP = 30
"""A positive curve whose largest value is so many times its smallest gets a logarithmic axis."""
TITLES = {
    "tracks": "trained on unsupervised tracks",
    "truth": "trained on true positions",
    TUNED: "trained on unsupervised tracks, then tuned together with the tracker",
}


def charts(evidence: Evidence, coverage_percent: Sequence[float]) -> dict[str, list[Chart]]:
    """Name of a figure to its panels, for figures that there are data for; for JSON.

    `coverage_percent` is what the ellipses claim to hold whose coverage is shown.
    """
    of_tracker = evidence.learning["model"].str.startswith("tracker")
    figures = {
        "tracker_errors": list(_tracker_errors(error_distributions(evidence.tracker_errors))),
        "horizons": list(_horizons(evidence.horizons, evidence.horizon)),
        "coverage": list(coverage_charts(coverage(evidence, coverage_percent), evidence.horizon)),
        "tracker_learning": list(_learning(evidence.learning[of_tracker])),
        "predictor_learning": list(_learning(evidence.learning[~of_tracker])),
    }
    return {name: panels for name, panels in figures.items() if panels}


def _tracker_errors(distributions: pd.DataFrame) -> Iterator[Chart]:
    """Share of frames tracked within so many pixels, the best tracker first."""
    if distributions.empty:
        return
    best_first = distributions.groupby("tracker")["share"].mean().sort_values(ascending=False, kind="stable").index
    lines = [
        line(
            name,
            f"tracker:{name}",
            colours.of_tracker(name),
            distributions[distributions["tracker"] == name][["error_px", "share"]],
            wide=name == "unsupervised",
        )
        for name in best_first
    ]
    yield {
        "title": "",
        "x": {"label": "error in px", "scale": "log", "at": "within {} px"},
        "y": {"label": "share of frames", "scale": "linear", "percent": True, "from": 0, "to": 1},
        "lines": lines,
    }


def _horizons(horizons: pd.DataFrame, horizon: int) -> Iterator[Chart]:
    """Mean error by number of frames since the first seen one, a panel a supervision."""
    marks = [[0, "0"], [horizon, f"T = {horizon}"], [2 * horizon, "2T"], [4 * horizon, "4T"]]
    for supervision in SUPERVISIONS:
        mine = horizons[horizons["supervision"] == supervision]
        lines = [
            line(
                str(name),
                f"predictor:{name}",
                colours.of_predictor(str(name)),
                curve[["frame", "error_px"]],
                dashed=name in BASELINES,
                wide=name not in BASELINES,
            )
            for name, curve in mine.groupby("predictor", sort=False)
        ]
        if lines:
            yield {
                "title": TITLES[supervision],
                "x": {"label": "frame (first seen = 0)", "scale": "linear", "at": "frame {}", "ticks": marks},
                # Errors start near 0: a logarithmic axis could not show them.
                "y": {"label": "mean error in px", "scale": "symlog", "from": 0},
                "lines": lines,
            }


def _learning(learning: pd.DataFrame) -> Iterator[Chart]:
    """A panel a kind of loss, over training steps."""
    styles = {model: _learner_style(model, number) for number, model in enumerate(learning["model"].unique())}
    for loss, mine in learning.groupby("loss", sort=False):
        lines = [
            line(str(model).removeprefix("tracker, "), points=curve[["step", "value"]], **styles[model])
            for model, curve in mine.groupby("model", sort=False)
        ]
        steep = (mine["value"] > 0).all() and mine["value"].max() > STEEP * mine["value"].min()
        yield {
            "title": LOSSES.get(str(loss), str(loss).replace("_", " ")),
            "x": {"label": "step", "scale": "linear", "at": "step {}"},
            "y": {"label": "", "scale": "log" if steep else "linear"},
            "lines": lines,
        }


def _learner_style(model: str, number: int) -> dict[str, Any]:
    name, _, supervision = model.partition(", ")
    if name == "tracker":
        return {"model": "tracker:unsupervised", "colour": colours.PALETTE[number % len(colours.PALETTE)]}
    style = {"model": f"predictor:{name}", "colour": colours.of_predictor(name)}
    return {**style, "dashed": supervision == "truth"}
