"""Spread over seeds: reproduces the committed pipeline once a seed, writes mean and worst of every headline figure.

    python benchmarks/seeds.py 0 1 2

Each seed runs in a clone of its own that shares this project's DVC cache, two at a time, so nothing that a seed does
not touch runs again and the workspace stays as it is. Writes benchmarks/seeds.json.
"""

import json
import platform
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import mean

ROOT = Path(__file__).resolve().parents[1]
OUT = Path(__file__).with_name("seeds.json")
AT_ONCE = 2
Figures = dict[str, float | bool | None]


def summary_of(seed: int) -> Figures:
    """The headline figures of one seed's run of the last commit."""
    with tempfile.TemporaryDirectory(prefix=f"seed{seed}-") as folder:
        clone = Path(folder) / "physpipe"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        cache = str(ROOT / ".dvc/cache")
        for setting, value in (("cache.dir", cache), ("cache.type", "symlink")):
            subprocess.run(["dvc", "config", "--local", setting, value], cwd=clone, check=True)
        params = clone / "params.yaml"
        params.write_text(re.sub(r"^  seed: \d+$", f"  seed: {seed}", params.read_text(), flags=re.MULTILINE))
        subprocess.run(["dvc", "repro", "--quiet"], cwd=clone, check=True)
        return json.loads((clone / "metrics/summary.json").read_text())


def spread(runs: list[Figures]) -> dict[str, dict[str, object]]:
    """Figure to its mean and worst over the seeds (largest error; false where any is), and its value for each."""
    table: dict[str, dict[str, object]] = {}
    for key in runs[0]:
        each = [run[key] for run in runs]
        numbers = [value for value in each if isinstance(value, float)]
        known = len(numbers) == len(each)
        worst = max(numbers) if known else all(each)
        table[key] = {"mean": round(mean(numbers), 4) if known else None, "worst": worst, "each": each}
    return table


def main() -> None:
    """Runs the seeds of the command line."""
    seeds = [int(word) for word in sys.argv[1:]]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], check=True, capture_output=True, text=True)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        table = spread(list(pool.map(summary_of, seeds)))
    about = {"commit": commit.stdout.strip(), "machine": platform.platform(), "seeds": seeds}
    OUT.write_text(json.dumps({**about, "figures": table}, indent=1) + "\n")
    for key, row in table.items():
        print(f"{key:48} mean {row['mean']}  worst {row['worst']}")


if __name__ == "__main__":
    main()
