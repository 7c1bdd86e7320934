"""Figures of the page, each a PNG; the same model has the same colour in all of them."""

import io
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from physpipe.predictors.horizon import BASELINES
from physpipe.report import colours
from physpipe.report.run import SUPERVISIONS

PANEL_INCHES = (5.2, 3.4)
LEGEND_INCHES = 1.6
TITLES = {"tracks": "trained on unsupervised tracks", "truth": "trained on true positions"}


def error_by_horizon(horizons: pd.DataFrame, horizon: int) -> bytes:
    """Mean error over the number of frames since the first seen one, a panel a supervision; T = `horizon`."""
    present = [each for each in SUPERVISIONS if (horizons["supervision"] == each).any()]
    figure, panels = _panels(len(present), columns=2, share_y=True)
    for axes, supervision in zip(panels, present, strict=True):
        mine = horizons[horizons["supervision"] == supervision]
        for name, curve in mine.groupby("predictor", sort=False):
            plain = name in BASELINES
            line: dict[str, Any] = {
                "color": colours.of_predictor(str(name)),
                "ls": "--" if plain else "-",
                "lw": 1.4 if plain else 2,
            }
            axes.plot(curve["frame"], curve["error_px"], label=name, **line)
        # Errors start at 0: a logarithmic axis could not show them.
        axes.set_yscale("symlog", linthresh=1.0)
        axes.set_xticks([0, horizon, 2 * horizon, 4 * horizon], ["0", f"T = {horizon}", "2T", "4T"])
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set(ylim=(0, None), xlabel="frame (first seen = 0)", title=TITLES[supervision])
        _legend(axes)
    panels[0].set_ylabel("mean error in px")
    return _png(figure)


def tracker_errors(distributions: pd.DataFrame) -> bytes:
    """Share of frames tracked within so many pixels; higher and further left is better."""
    figure, (axes,) = _panels(1, columns=1, width=1.5)
    best_first = distributions.groupby("tracker")["share"].mean().sort_values(ascending=False).index
    for name in best_first:
        curve = distributions[distributions["tracker"] == name]
        line: dict[str, Any] = {"color": colours.of_tracker(name), "lw": 2.6 if name == "unsupervised" else 1.3}
        axes.plot(curve["error_px"], curve["share"], label=name, zorder=3 if name == "unsupervised" else 2, **line)
    axes.set(xscale="log", ylim=(0, 1.02), xlabel="error in px", ylabel="share of frames within that error")
    axes.xaxis.set_major_formatter("{x:g}")
    _legend(axes)
    return _png(figure)


def learning_curves(learning: pd.DataFrame) -> bytes:
    """A panel a kind of loss, over training steps."""
    losses = list(learning["loss"].unique())
    figure, panels = _panels(len(losses), columns=4, width=0.62)
    styles = {model: _learner_style(model, number) for number, model in enumerate(learning["model"].unique())}
    lines: dict[str, Line2D] = {}
    for axes, loss in zip(panels, losses, strict=True):
        mine = learning[learning["loss"] == loss]
        for model, curve in mine.groupby("model", sort=False):
            lines[model] = axes.plot(curve["step"], curve["value"], lw=1.3, **styles[model])[0]
        axes.set_title(loss, size=9)
        axes.set_xlabel("step", size=8)
        axes.tick_params(labelsize=7)
        if (mine["value"] > 0).all() and mine["value"].max() > 30 * mine["value"].min():
            axes.set_yscale("log")
    columns = int(figure.get_figwidth() / LEGEND_INCHES)
    figure.legend(lines.values(), lines.keys(), loc="outside upper left", ncols=columns, fontsize=8, frameon=False)
    return _png(figure)


def _learner_style(model: str, number: int) -> dict[str, Any]:
    name, _, supervision = model.partition(", ")
    if name == "tracker":
        return {"color": colours.PALETTE[number % len(colours.PALETTE)]}
    return {"color": colours.of_predictor(name), "ls": ":" if supervision == "truth" else "-"}


def _panels(count: int, columns: int, width: float = 1.0, share_y: bool = False) -> tuple[Figure, list[Axes]]:
    columns = min(columns, max(count, 1))
    rows = -(-count // columns)
    size = (PANEL_INCHES[0] * width * columns, PANEL_INCHES[1] * min(width, 1) * rows)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False, sharey=share_y).ravel()
    for empty in grid[count:]:
        empty.remove()
    for axes in grid[:count]:
        axes.grid(color="#e4e4e4", lw=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    return figure, list(grid[:count])


def _legend(axes: Axes) -> None:
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.02))


def _png(figure: Figure) -> bytes:
    memory = io.BytesIO()
    FigureCanvasAgg(figure).print_png(memory, metadata={"Software": None})  # no version in the bytes
    return memory.getvalue()
