"""Every predictor of the paper and ours, on the data sets of its tables: which experiments, and the rows that come of
them."""

from collections.abc import Mapping, Sequence
from typing import Any

from experiments.records import Experiment, Result, about, on_one_set
from experiments.spread import over_seeds
from experiments.tracker_runs import Table

OURS = "terrain"
"""Stands beside every predictor of the paper."""
SIZE = "full"
"""Key of `simulate.sizes`: where a data set has it, ours also learns from that many clips."""
FULL = f"_{SIZE}"
"""Ends the name of such a set in the tables."""


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


def at_full_size(
    wanted: Mapping[str, Mapping[str, Sequence[str]]], datasets: Mapping[str, Any]
) -> dict[str, dict[str, list[str]]]:
    """What is to run besides the grid `wanted`, as a grid: ours, on sets that have a full size."""
    sizes = {name: datasets[name].get("simulate", {}).get("sizes", {}) for name in wanted}
    return {f"{name}{FULL}": {OURS: list(wanted[name][OURS])} for name, each in sizes.items() if SIZE in each}


def experiments(
    wanted: Mapping[str, Mapping[str, Sequence[str]]], datasets: Mapping[str, Any], seed: int
) -> dict[tuple[str, str], Experiment]:
    """(data set, predictor) to its experiment, in the order to run."""
    return {
        (name, predictor): Experiment(
            f"forecasts-{name}-{predictor}-seed{seed}",
            _told(name, seed, datasets, predictor, "truth" in sources),
            "predictors",
        )
        for name, predictors in wanted.items()
        for predictor, sources in predictors.items()
    }


def _told(name: str, seed: int, datasets: Mapping[str, Any], predictor: str, supervised: bool) -> tuple[str, ...]:
    dataset = name.removesuffix(FULL)
    told = on_one_set(dataset, seed, "simulate" in datasets[dataset], predictor, supervised)
    return told if name == dataset else (*told, f"datasets.{dataset}.simulate.size={SIZE}")


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
            for predictor, row in result.figures[name.removesuffix(FULL)].get(source, {}).items():
                block.setdefault(predictor, {**over_seeds({seed: row}), **about({seed: result})})
    return table
