"""What each loss, and each ingredient of the default recipe, is worth: `make ablation`.

    python -m experiments.ablation --set bowlr_sim --seeds 0,1,2

Writes metrics/ablation.json and docs/results/ablation.png. Variants that have run are not run again.
"""

import argparse
import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from scipy.stats import spearmanr

from experiments.ablation_chart import draw
from experiments.queue import run_missing
from experiments.records import CommandError, Experiment, Result, on_one_set, read_results
from experiments.spread import Row, over_seeds
from experiments.variants import ALL_LOSSES, CONSTANT, variants

TRACKER = "unsupervised_unrefined"
"""Row that tells: refinement would hide what is lost."""
FIGURES = ("mean_px", "p99_px", "off_track", "locked")


def experiments(dataset: str, simulated: bool, seeds: Sequence[int]) -> dict[tuple[str, str, int], Experiment]:
    """(part, row, seed) to its experiment."""
    return {
        (part, row, seed): Experiment(
            f"ablation-{dataset}-{part}-{row.replace('+', '-').replace(' ', '-')}-seed{seed}",
            (*on_one_set(dataset, seed, simulated), "baselines.names=[centre]", *overrides),
        )
        for part, rows in variants().items()
        for row, overrides in rows.items()
        for seed in seeds
    }


def collect(
    wanted: Mapping[tuple[str, str, int], Experiment], results: Mapping[Experiment, Result], dataset: str
) -> dict[str, Any]:
    """What metrics/ablation.json holds: part to row to figures, null for a row that lacks a seed; and `choice`."""
    parts: dict[str, Any] = {"dataset": dataset, "choice": {}}
    for part, rows in variants().items():
        parts[part] = {}
        for row in rows:
            mine = {key[2]: results.get(each) for key, each in wanted.items() if key[:2] == (part, row)}
            found = {seed: result for seed, result in mine.items() if result}
            parts[part][row] = _row(found, dataset, TRACKER) if len(found) == len(mine) else None
        runs = [
            results[each].figures[dataset][TRACKER]
            for key, each in wanted.items()
            if key[0] == part and each in results
        ]
        parts["choice"][part] = choice(runs)
    full = {key[2]: results[each] for key, each in wanted.items() if key[1] == ALL_LOSSES and each in results}
    parts["losses"][CONSTANT] = _row(full, dataset, "centre") if full else None
    return parts


def choice(runs: Sequence[Row]) -> Row:
    """How well the score that chooses starts and checkpoints without labels orders runs by their true mean error:
    Spearman's rank correlation, null below three runs that have both.
    """
    known = [(row["score"], row["mean_px"]) for row in runs if None not in (row.get("score"), row.get("mean_px"))]
    correlation = spearmanr(*zip(*known, strict=True)).statistic if len(known) > 2 else None
    return {"runs": len(known), "spearman": None if correlation is None else round(float(correlation), 3)}


def _row(found: Mapping[int, Result], dataset: str, tracker: str) -> Row:
    figures = {seed: {key: each.figures[dataset][tracker].get(key) for key in FIGURES} for seed, each in found.items()}
    commits = sorted({each.commit for each in found.values()})
    return {**over_seeds(figures), "seeds": sorted(found), "commit": ", ".join(commits)}


def main() -> None:
    """Runs what is missing, then writes what there is; exits with an error when a variant failed."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--set", default="bowlr_sim", help="data set, a section under `datasets`")
    options.add_argument("--seeds", default="0,1,2")
    options.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="experiments at once")
    options.add_argument("--collect", action="store_true", help="run nothing, write what there is")
    chosen = options.parse_args()
    known = yaml.safe_load(Path("params.yaml").read_text())["datasets"]
    if chosen.set not in known:
        sys.exit(f"params.yaml has no data set `{chosen.set}`; it has {', '.join(known)}")
    seeds = [int(word) for word in chosen.seeds.split(",")]
    wanted = experiments(chosen.set, "simulate" in known[chosen.set], seeds)
    try:
        failed = {} if chosen.collect else run_missing(list(wanted.values()), chosen.jobs)
        parts = collect(wanted, read_results(list(wanted.values())), chosen.set)
    except CommandError as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
    Path("metrics/ablation.json").write_text(json.dumps(parts, indent=1) + "\n")
    draw(Path("docs/results/ablation.png"), parts)
    for experiment, reason in failed.items():
        print(f"failed {experiment.label}: {reason}", file=sys.stderr)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
