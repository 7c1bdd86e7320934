"""Every tracker and every predictor on every data set that can run here: `make results`.

    python -m experiments.results --seeds 0,1,2

Writes trackers.json, predictors.json and finetuned.json in docs/results, and docs/results.md. May be stopped and
started again: what has run stays, and rows of an earlier commit stand until they are measured again. Predictors take
the first seed.
"""

import argparse
import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from experiments import findings, forecast_runs, forecast_tables, tables, tracker_runs, tuning_runs
from experiments.queue import run_missing
from experiments.records import CommandError, read_results
from experiments.spread import Row
from experiments.tracker_runs import RECIPES, Table

FOLDER, PAGE, SPEED = Path("docs/results"), Path("docs/results.md"), Path("benchmarks/speed.json")
FILM, PAPER = Path("data/raw"), Path("physpipe/report/paper.yaml")
FORECASTS, FINETUNED = "forecasts", "finetuned"
"""What runs beside the trackers' RECIPES."""


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


def kept(known: Table, new: Table) -> Table:
    """The new rows, and those of before that were not measured again with as many seeds; each says its commit."""
    names = [*new, *(name for name in known if name not in new)]
    return {name: {**known.get(name, {}), **_as_sure(known.get(name, {}), new.get(name, {}))} for name in names}


def ordered(table: Table, names: Sequence[str]) -> Table:
    """The table's data sets in the order of `names`, others after them."""
    return {name: table[name] for name in dict.fromkeys([*names, *table]) if name in table}


def _as_sure(known: Mapping[str, Row], new: Mapping[str, Row]) -> dict[str, Row]:
    return {key: row for key, row in new.items() if len(row["seeds"]) >= len(known.get(key, {"seeds": ()})["seeds"])}


def main() -> None:
    """Runs what is missing, then writes what there is; exits with an error when an experiment failed."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--sets", help="some of the data sets only, a,b")
    options.add_argument("--recipes", default=",".join((*RECIPES, FORECASTS, FINETUNED)), help="what runs, a,b")
    options.add_argument("--seeds", default="0,1,2")
    options.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="experiments at once")
    options.add_argument("--collect", action="store_true", help="run nothing, write what there is")
    chosen = options.parse_args()
    datasets = yaml.safe_load(Path("params.yaml").read_text())["datasets"]
    names, absent = runnable(datasets, FILM)
    seeds = [int(word) for word in chosen.seeds.split(",")]
    followed = tracker_runs.experiments(names, datasets, seeds)
    grid = forecast_runs.grid(yaml.safe_load(PAPER.read_text()), names)
    tuned = tuning_runs.experiments(list(grid), datasets, seeds[0])
    grid |= forecast_runs.at_full_size(grid, datasets)
    forecast = forecast_runs.experiments(grid, datasets, seeds[0])
    asked = set(chosen.sets.split(",") if chosen.sets else names), set(chosen.recipes.split(","))
    now = [each for (name, recipe, _), each in followed.items() if name in asked[0] and recipe in asked[1]]
    now += [
        each
        for (name, _), each in forecast.items()
        if name.removesuffix(forecast_runs.FULL) in asked[0] and FORECASTS in asked[1]
    ]
    now += [each for name, each in tuned.items() if name in asked[0] and FINETUNED in asked[1]]
    try:
        failed = {} if chosen.collect else run_missing(now, chosen.jobs)
        results = read_results([*followed.values(), *forecast.values(), *tuned.values()])
        results |= read_results([tuning_runs.of_trackers(each) for each in tuned.values()])
    except CommandError as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
    speed = _known(SPEED) or {"rates": {}}
    measured = tracker_runs.collect(followed, results, speed["rates"])
    trackers = ordered(kept(_known(FOLDER / "trackers.json"), measured), names)
    before, new = _known(FOLDER / "predictors.json"), forecast_runs.collect(forecast, results, seeds[0])
    predictors = {name: kept(before.get(name, {}), new.get(name, {})) for name in {**new, **before}}
    together = ordered(_known(FOLDER / "finetuned.json") | tuning_runs.collect(tuned, results, seeds[0]), names)
    for name, table in (("trackers", trackers), ("predictors", predictors), ("finetuned", together)):
        _save(name, table)
    unrun = {name: absent.get(name, "not run yet") for name in datasets if name not in trackers}
    pages = [tables.page(trackers, unrun, speed), forecast_tables.page(predictors, grid), findings.page(predictors)]
    PAGE.write_text("\n".join([*pages, tuning_runs.page(together, list(tuned))]))
    for experiment, reason in failed.items():
        print(f"failed {experiment.label}: {reason}", file=sys.stderr)
    sys.exit(bool(failed))


def _known(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text()) if path.is_file() else {}
    return found


def _save(name: str, table: Mapping[str, Any]) -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / f"{name}.json").write_text(json.dumps(table, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
