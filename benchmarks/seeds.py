"""Spread over seeds: runs the pipeline once a seed in copies of the workspace, writes mean and worst of every figure.

    python benchmarks/seeds.py 0 1 2

Each run is an experiment (`dvc exp run --temp -S compute.seed=N`), so nothing runs twice and nothing in the workspace
changes but benchmarks/seeds.json.
"""

import json
import subprocess
import sys
from pathlib import Path
from statistics import mean

OUT = Path(__file__).with_name("seeds.json")


def summary_of(seed: int) -> dict[str, float | bool | None]:
    """The headline figures of one seed's run."""
    name = f"seed-{seed}"
    words = ["dvc", "exp", "run", "--temp", "--force", "--name", name, "--set-param", f"compute.seed={seed}"]
    subprocess.run(words, check=True)
    shown = subprocess.run(["git", "show", f"{_ref(name)}:metrics/summary.json"], check=True, capture_output=True)
    return json.loads(shown.stdout)


def _ref(name: str) -> str:
    refs = subprocess.run(["git", "for-each-ref", "--format=%(refname)", "refs/exps"], check=True, capture_output=True)
    return next(line for line in refs.stdout.decode().split() if line.endswith("/" + name))


def spread(runs: list[dict[str, float | bool | None]]) -> dict[str, dict[str, object]]:
    """Figure to its mean, its worst (largest error, or false) and its value for every seed."""
    table = {}
    for key in runs[0]:
        values = [run.get(key) for run in runs]
        numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
        if len(numbers) == len(values):
            table[key] = {"mean": round(mean(numbers), 4), "worst": max(numbers), "each": values}
        else:
            table[key] = {"mean": None, "worst": all(values) if None not in values else None, "each": values}
    return table


def main() -> None:
    """Runs the seeds of the command line."""
    seeds = [int(word) for word in sys.argv[1:]]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], check=True, capture_output=True, text=True)
    table = spread([summary_of(seed) for seed in seeds])
    OUT.write_text(json.dumps({"commit": commit.stdout.strip(), "seeds": seeds, "figures": table}, indent=1) + "\n")
    for key, row in table.items():
        print(f"{key:48} mean {row['mean']}  worst {row['worst']}")


if __name__ == "__main__":
    main()
