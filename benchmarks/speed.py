"""Times what users wait for, on the data sets of the last `dvc repro`; prints it and keeps it.

    python benchmarks/speed.py bowls bowls2

Frames/s of every tracker on one thread (reading the clips included, all objects, ours with its positions refined), of
ours on all cores, seconds of the first detector's training, and of finding out what `dvc repro` has to do. Writes
benchmarks/speed.json, which docs/results.md takes the rates from.
"""

import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import Any

import cv2
import torch

from physpipe.baselines.running import baseline_tracks
from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BaselineParams, Settings, known_flows
from physpipe.core.ball import BallParams
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.objects import ObjectsParams
from physpipe.core.parallel import worker_count
from physpipe.core.params import read, read_value
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet, Split
from physpipe.trackers import detectors
from physpipe.trackers.tables import track_tables

OUT = Path(__file__).with_name("speed.json")
SCRATCH = Path(".scratch/benchmark")
OURS = {"joint": "unsupervised_joint", "sequential": "unsupervised"}
"""Recipe to the name of its tracker."""


def seconds(work: Callable[[], object]) -> float:
    """Wall-clock time of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def stage(*words: str) -> Callable[[], object]:
    """A stage as DVC runs it, its outputs in a scratch folder."""
    return lambda: subprocess.run([sys.executable, "-m", *words], check=True, stderr=subprocess.DEVNULL)


def baseline(name: str, tracker: str) -> Callable[[], object]:
    """One of the trackers to compare with, as its stage runs it."""
    clips = ClipSet(Path("data/clips") / name)
    given = annotations.load(Path("data/annotations") / name, clips)
    truth = tracks.load(Path("data/truth") / f"{name}.parquet")
    params = read("baselines", BaselineParams).model_copy(update={"names": [tracker]})
    radius_px = read(f"datasets.{name}.evaluate", BallParams).ball_radius_px
    settings = Settings(params, read("ground_truth", TemplateParams), radius_px, known_flows(params))
    return lambda: baseline_tracks(clips, given, truth, settings)


def unsupervised(name: str) -> Callable[[], object]:
    """Ours, with the detectors that were learned."""
    clips = ClipSet(Path("data/clips") / name)
    nets = detectors.load(Path("data/tracker") / name / "all" / detectors.WEIGHTS)
    params, objects = read("tracker.tracking", detectors.TrackingParams), read(f"datasets.{name}.motion", ObjectsParams)
    tracker = detectors.together(nets, params)
    return lambda: track_tables(clips, tracker, objects, params.refine)


def rates(name: str) -> dict[str, float]:
    """Tracker to frames/s on one thread: ours on all clips of data set `name`, the others on the test clips."""
    work = {each: baseline(name, each) for each in read("baselines", BaselineParams).names}
    measured = {OURS[read_value("tracker.recipe")]: rate(unsupervised(name), name)}
    return measured | {tracker: rate(each, name, "test") for tracker, each in work.items()}


def rate(work: Callable[[], object], name: str, *splits: Split) -> float:
    """Frames/s of work on the clips of some splits, or on all."""
    clips = ClipSet(Path("data/clips") / name)
    return round(sum(len(clips.rows(each)) for each in clips.names(*splits)) / seconds(work), 1)


def processor() -> str:
    """The processor's name, where the system tells it, and its vector instructions."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text().splitlines() if told.is_file() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    name = models[0] if models else platform.processor() or platform.machine()
    return f"{name} {torch.backends.cpu.get_cpu_capability()}"


def main(names: list[str]) -> None:
    """Measures the data sets `names`; those measured before on the same machine are kept."""
    prepare(read("compute", ComputeParams).model_copy(update={"threads": 1}))
    cv2.setNumThreads(1)
    machine = f"{processor()}, torch {torch.__version__}"
    kept = json.loads(OUT.read_text()) if OUT.is_file() else {}
    new: dict[str, Any] = {"machine": machine, "cores": worker_count(), "rates": {}, "all_cores": {}, "training_s": {}}
    table = kept if kept.get("machine") == machine else new
    table |= {"date": date.today().isoformat()}
    for name in names:
        table["all_cores"][name] = rate(unsupervised(name), name)
        os.environ["PHYSPIPE_WORKERS"] = "1"
        table["rates"][name] = rates(name)
        del os.environ["PHYSPIPE_WORKERS"]
        training = stage("stages.train_tracker", f"data/clips/{name}", str(SCRATCH / name))
        table["training_s"][name] = round(seconds(training), 1)
        for what, value in table["rates"][name].items():
            print(f"| {name} | {what} | {value:.0f} frames/s |")
        print(f"| {name} | ours on {table['cores']} cores | {table['all_cores'][name]:.0f} frames/s |")
        print(f"| {name} | training | {table['training_s'][name]:.0f} s |")
    table["status_s"] = round(seconds(lambda: subprocess.run(["dvc", "status", "--quiet"])), 1)
    print(f"| dvc status | {table['status_s']} s |\n{machine}")
    OUT.write_text(json.dumps(table, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
