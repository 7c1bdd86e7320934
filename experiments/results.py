"""Every tracker on every data set that can run here, three seeds: `make results`.

    python -m experiments.results --seeds 0,1,2 --jobs 1

Writes docs/results/trackers.json and docs/results.md. May be stopped and started again: what has run stays, and rows of
an earlier commit stand until they are measured again.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from experiments.queue import run_missing
from experiments.records import CommandError, Experiment, Result, read_results, tracker_only
from experiments.spread import Row, over_seeds
from experiments.tables import page

RECIPES = {"joint": "unsupervised_joint", "sequential": "unsupervised", "flow": "unsupervised_joint"}
"""What runs to the key of our tracker's rows: its two recipes, and the first again beside trackers on learned flow."""
JSON, PAGE, SPEED = Path("docs/results/trackers.json"), Path("docs/results.md"), Path("benchmarks/speed.json")
FILM = Path("data/raw")
Table = dict[str, dict[str, Row]]


def runnable(datasets: Mapping[str, Any], film: Path) -> tuple[list[str], dict[str, str]]:
    """Data sets that can run here, cheapest first, and why the others cannot.

    Cheap are few objects, a training each, and then few frames; film comes before simulations.
    """
    absent = {
        name: f"no film: neither simulated nor in {film.as_posix()}/{name}.dvc"
        for name, section in datasets.items()
        if "simulate" not in section and not (film / f"{name}.dvc").is_file()
    }
    return sorted((name for name in datasets if name not in absent), key=lambda name: _cost(datasets[name])), absent


def _cost(section: Mapping[str, Any]) -> tuple[int, int]:
    simulated = section.get("simulate")
    clips = simulated["sizes"][simulated["size"]]["clips"] if simulated else 0
    return section["motion"]["objects"] or 1, clips * section["ingest"]["clip_frames"]


def experiments(
    names: Sequence[str], datasets: Mapping[str, Any], seeds: Sequence[int]
) -> dict[tuple[str, str, int], Experiment]:
    """(data set, recipe, seed) to its experiment, in the order to run; learned flow with one seed only."""
    return {
        (name, recipe, seed): Experiment(
            f"results-{name}-{recipe}-seed{seed}",
            (*tracker_only(name, seed, "simulate" in datasets[name]), *_told(recipe, name)),
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
        for tracker in next(iter(found.values())).trackers[name] if found else ():
            rows = {seed: each.trackers[name][tracker] for seed, each in found.items()}
            key = tracker.replace("unsupervised", RECIPES[recipe])
            rate = speed.get(name, {}).get(key)
            table.setdefault(name, {}).setdefault(key, {**over_seeds(rows), **_about(found), "frames_per_s": rate})
    return table


def kept(known: Table, new: Table) -> Table:
    """The new rows, and those of before that were not measured again; each says its commit."""
    names = [*new, *(name for name in known if name not in new)]
    return {name: {**known.get(name, {}), **new.get(name, {})} for name in names}


def _about(found: Mapping[int, Result]) -> Row:
    times = [each.time_s for each in found.values()]
    return {
        "commit": ", ".join(sorted({each.commit for each in found.values()})),
        "seeds": sorted(found),
        "machine": ", ".join(sorted({each.machine or "elsewhere" for each in found.values()})),
        "finished": max(each.finished for each in found.values()),
        "time_s": None if None in times else max(time for time in times if time is not None),
    }


def main() -> None:
    """Runs what is missing, then writes what there is; exits with an error when an experiment failed."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--sets", help="some of the data sets only, a,b")
    options.add_argument("--recipes", default=",".join(RECIPES), help="what runs, a,b")
    options.add_argument("--seeds", default="0,1,2")
    options.add_argument("--jobs", type=int, default=1, help="experiments at once")
    options.add_argument("--collect", action="store_true", help="run nothing, write what there is")
    chosen = options.parse_args()
    datasets = yaml.safe_load(Path("params.yaml").read_text())["datasets"]
    names, unrun = runnable(datasets, FILM)
    wanted = experiments(names, datasets, [int(word) for word in chosen.seeds.split(",")])
    asked = set(chosen.sets.split(",") if chosen.sets else names), set(chosen.recipes.split(","))
    now = [each for key, each in wanted.items() if key[0] in asked[0] and key[1] in asked[1]]
    try:
        failed = {} if chosen.collect else run_missing(now, chosen.jobs)
        results = read_results(list(wanted.values()))
    except CommandError as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
    speed = json.loads(SPEED.read_text()) if SPEED.is_file() else {"rates": {}, "machine": None}
    known = json.loads(JSON.read_text()) if JSON.is_file() else {}
    table = kept(known, collect(wanted, results, speed["rates"]))
    told = {key[0]: reason for key, each in wanted.items() for other, reason in failed.items() if each == other}
    unrun |= {name: f"failed: {told[name]}" if name in told else "not run yet" for name in names if name not in table}
    JSON.parent.mkdir(parents=True, exist_ok=True)
    JSON.write_text(json.dumps(table, indent=1, sort_keys=True) + "\n")
    PAGE.write_text(page(table, unrun, speed["machine"]))
    for experiment, reason in failed.items():
        print(f"failed {experiment.label}: {reason}", file=sys.stderr)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
