"""The bars of docs/results/ablation.png."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from experiments.spread import Row
from experiments.variants import CONSTANT, variants

COLOURS = {"mean_px": "#3b6ea5", "p99_px": "#c9d6e4"}


def draw(path: Path, parts: Mapping[str, Any]) -> None:
    """Bars of the mean error and, behind them, of the 99th percentile: the constant and the paper's combinations, then
    our recipe less one ingredient each, the worst first.
    """
    losses = {name: parts["losses"][name] for name in (CONSTANT, *variants()["losses"])}
    ingredients = sorted(_known(parts["ingredients"]).items(), key=lambda item: -item[1]["mean_px"])
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
    _bars(axes[0], _known(losses), "Losses")
    _bars(axes[1], dict(ingredients), "Ingredients of the recipe")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130, metadata={"Software": None})
    plt.close(figure)


def _known(rows: Mapping[str, Row | None]) -> dict[str, Row]:
    return {name: row for name, row in rows.items() if row and row["mean_px"] is not None}


def _bars(axes: Any, rows: Mapping[str, Row], title: str) -> None:
    names = list(rows)
    for key, label in (("p99_px", "99th percentile"), ("mean_px", "mean")):
        axes.barh(names, [row[key] for row in rows.values()], color=COLOURS[key], label=label)
    figures = [f"{row['mean_px']:.2f} / {row['p99_px']:.1f}" for row in rows.values()]
    axes.bar_label(axes.containers[0], figures, padding=3, fontsize=8)
    axes.invert_yaxis()
    axes.margins(x=0.3)
    axes.set(title=title, xlabel="error, px: mean / 99th percentile", xscale="symlog")
    axes.spines[["top", "right"]].set_visible(False)
