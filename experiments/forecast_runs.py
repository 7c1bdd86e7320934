"""Every predictor of the paper and ours, on the data sets of its tables: which experiments, and the rows that come of
them."""

from collections.abc import Mapping, Sequence
from typing import Any

from experiments.records import Experiment, Result, about, on_one_set
from experiments.spread import over_seeds
from experiments.tracker_runs import Table

OURS = "terrain"
"""Stands beside every predictor of the paper."""


def grid(paper: Mapping[str, Any], names: Sequence[str]) -> dict[str, dict[str, list[str]]]:
    """Data set to predictor to what it learns from, `tracks` and, as in the paper, `truth`.

    `paper` holds its printed figures (`predictors`), and whose figures stand beside a stand-in's (`stand_ins`).
    """
    printed = {name: paper["predictors"].get(paper["stand_ins"].get(name, name), {}) for name in names}
    with_ours = {name: {source: [*rows, OURS] for source, rows in blocks.items()} for name, blocks in printed.items()}
    return {
        name: {each: [source for source, rows in blocks.items() if each in rows] for each in blocks["tracks"]}
        for name, blocks in with_ours.items()
        if blocks
    }


def experiments(
    wanted: Mapping[str, Mapping[str, Sequence[str]]], datasets: Mapping[str, Any], seed: int
) -> dict[tuple[str, str], Experiment]:
    """(data set, predictor) to its experiment, in the order to run."""
    return {
        (name, predictor): Experiment(
            f"forecasts-{name}-{predictor}-seed{seed}",
            on_one_set(name, seed, "simulate" in datasets[name], predictor, supervised="truth" in sources),
            "predictors",
        )
        for name, predictors in wanted.items()
        for predictor, sources in predictors.items()
    }


def collect(
    wanted: Mapping[tuple[str, str], Experiment], results: Mapping[Experiment, Result], seed: int
) -> dict[str, Table]:
    """Data set to what was learned from to predictor to figures, with commit, seeds, machine, time_s, finished.

    Predictors that learn nothing have the rows of the first experiment of the set.
    """
    table: dict[str, Table] = {}
    for (name, _), experiment in wanted.items():
        if experiment not in results:
            continue
        result = results[experiment]
        for source in ("tracks", "truth"):
            block = table.setdefault(name, {}).setdefault(source, {})
            for predictor, row in result.figures[name].get(source, {}).items():
                block.setdefault(predictor, {**over_seeds({seed: row}), **about({seed: result})})
    return table
