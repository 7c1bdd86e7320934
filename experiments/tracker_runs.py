"""Every tracker on every data set: which experiments that takes, and the rows that come of them."""

from collections.abc import Mapping, Sequence
from typing import Any

from experiments.records import Experiment, Result, about, on_one_set
from experiments.spread import Row, over_seeds

RECIPES = {"joint": "unsupervised_joint", "sequential": "unsupervised", "flow": "unsupervised_joint"}
"""What runs to the key of our tracker's rows: its two recipes, and the first again beside trackers on learned flow."""
Table = dict[str, dict[str, Row]]
"""Data set to tracker to figures."""


def experiments(
    names: Sequence[str], datasets: Mapping[str, Any], seeds: Sequence[int]
) -> dict[tuple[str, str, int], Experiment]:
    """(data set, recipe, seed) to its experiment, in the order to run; learned flow with one seed only."""
    return {
        (name, recipe, seed): Experiment(
            f"results-{name}-{recipe}-seed{seed}",
            (*on_one_set(name, seed, "simulate" in datasets[name]), *_told(recipe, name)),
        )
        for recipe in RECIPES
        for name in names
        for seed in (seeds[:1] if recipe == "flow" else seeds)
    }


def _told(recipe: str, name: str) -> tuple[str, ...]:
    if recipe == "sequential":
        return ("tracker.recipe=sequential",)
    joint = ("tracker.recipe=joint", f"datasets.{name}.motion.objects=null")
    return (*joint, "run.flow=[corrflow]") if recipe == "flow" else joint


def collect(
    wanted: Mapping[tuple[str, str, int], Experiment],
    results: Mapping[Experiment, Result],
    speed: Mapping[str, Mapping[str, float]],
) -> Table:
    """Data set to tracker to figures over the seeds that have run, with commit, seeds, machine, time_s, finished.

    `speed` is data set to tracker to frames/s.
    """
    table: Table = {}
    for name, recipe in dict.fromkeys(key[:2] for key in wanted):
        found = {key[2]: results[each] for key, each in wanted.items() if key[:2] == (name, recipe) and each in results}
        for tracker in next(iter(found.values())).figures[name] if found else ():
            rows = {seed: each.figures[name][tracker] for seed, each in found.items()}
            key = tracker.replace("unsupervised", RECIPES[recipe])
            rate = speed.get(name, {}).get(key)
            table.setdefault(name, {}).setdefault(key, {**over_seeds(rows), **about(found), "frames_per_s": rate})
    return table
