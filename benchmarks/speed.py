"""Times the parts that users wait for, on the data sets of the last `dvc repro`; prints a table with its machine.

python benchmarks/speed.py bowls
"""

import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import torch

from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io.clips import ClipSet
from physpipe.trackers import detectors
from physpipe.trackers.learned import ReadoutParams
from physpipe.trackers.sequential import MaskParams


def seconds(work: Callable[[], object]) -> float:
    """Wall-clock time of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def stage(*words: str) -> Callable[[], object]:
    """A stage as DVC runs it, its outputs in a scratch folder."""
    return lambda: subprocess.run([sys.executable, "-m", *words], check=True, stderr=subprocess.DEVNULL)


def main(name: str) -> None:
    """Prints the table for data set `name`."""
    prepare(read("compute", ComputeParams))
    clips = ClipSet(Path("data/clips") / name)
    frames = sum(len(clips.rows(each)) for each in clips.names("test"))
    nets = detectors.load(Path("data/tracker") / name / "all" / detectors.WEIGHTS)
    tracker = detectors.together(nets, read("tracker.readout", ReadoutParams), read("tracker.mask", MaskParams))
    out = Path(".scratch/benchmark")
    rows = {
        "inference, frames/s": frames
        / seconds(lambda: [tracker.track_all(clips.frames(n)) for n in clips.names("test")]),
        "train_tracker, s": seconds(stage("stages.train_tracker", f"data/clips/{name}", str(out / "first"))),
        "no-op dvc repro, s": seconds(lambda: subprocess.run(["dvc", "repro", "--quiet"], check=True)),
    }
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, torch {torch.__version__}")
    for what, value in rows.items():
        print(f"| {what} | {value:.1f} |")


if __name__ == "__main__":
    main(sys.argv[1])
