"""Runs named variants of the pipeline through DVC's queue and reads back what they measured.

Each variant runs in a copy of the project that shares its cache, so what a variant does not touch runs once. Results
stay in Git (`dvc exp show`): a variant that has some for today's code is not run again, on whatever commit it ran.
`dvc config --local cache.type symlink` spares every copy its own files.
"""

import hashlib
import json
import platform
import re
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, NamedTuple

CODE = ["physpipe", "stages", "data", "dvc.yaml", "params.yaml"]
"""What the results of an experiment depend on."""
COSTS = Path(".scratch/experiments")
POLL_S = 10.0
PATIENCE = 6
"""Polls without a worker after which DVC's queue counts as broken."""
Runner = Callable[..., str]


class CommandError(Exception):
    """A command failed; holds what it printed."""


class Experiment(NamedTuple):
    """One variant of the pipeline."""

    label: str
    """Letters, digits, `_` and `-`."""
    overrides: tuple[str, ...]
    """Of params.yaml, as `dvc exp run -S` takes them."""

    @property
    def name(self) -> str:
        """Its name in DVC: other overrides under the same label are another experiment."""
        return f"{self.label}-{hashlib.sha256(chr(10).join(self.overrides).encode()).hexdigest()[:6]}"


class Result(NamedTuple):
    """What one experiment measured."""

    trackers: dict[str, dict[str, dict[str, Any]]]
    """metrics/trackers.json: data set to tracker to figures."""
    commit: str
    """Of the code, shortened."""
    finished: str
    """ISO date and time."""
    machine: str | None
    """Null when the experiment was not run from this folder."""
    time_s: float | None
    """Wall-clock seconds from start to end, to within POLL_S; seconds where DVC had most stages in its cache."""


class Task(NamedTuple):
    """A line of `dvc queue status`."""

    id: str
    name: str
    state: str


def command(*words: str) -> str:
    """What a command prints; raises CommandError with what it said when it fails."""
    # Files, not pipes: DVC's workers inherit them, and a pipe ends only with its last holder.
    with TemporaryFile("w+") as printed, TemporaryFile("w+") as complained:
        code = subprocess.run(words, stdout=printed, stderr=complained).returncode
        printed.seek(0)
        complained.seek(0)
        told = printed.read()
        if code:
            raise CommandError(f"`{' '.join(words[:4])}` failed: {(complained.read() or told).strip()[-2000:]}")
    return told


def tracker_only(dataset: str, seed: int, simulated: bool) -> tuple[str, ...]:
    """Overrides that leave nothing to run but one data set's trackers."""
    return (
        f"run.datasets=[{dataset}]",
        f"run.simulated=[{dataset if simulated else ''}]",
        "run.learned=[]",
        "run.supervised=[]",
        "report.predictor=persistence",
        f"compute.seed={seed}",
    )


def finished(run: Runner = command) -> dict[str, str]:
    """Name to revision of every experiment whose code is today's."""
    today: dict[str, bool] = {}
    revisions = {}
    for line in run("git", "for-each-ref", "--format=%(objectname) %(refname)", "refs/exps").splitlines():
        found = re.fullmatch(r"(\w+) refs/exps/(\w{2})/(\w{38})/(.+)", line)
        if found:
            revision, base, name = found[1], found[2] + found[3], found[4]
            if base not in today:
                today[base] = not run("git", "diff", "--name-only", base, "HEAD", "--", *CODE).strip()
            if today[base]:
                revisions[name] = revision
    return revisions


def read_results(wanted: Sequence[Experiment], run: Runner = command) -> dict[Experiment, Result]:
    """Results of those that have finished on today's code."""
    revisions = finished(run)
    return {each: _read(each, revisions[each.name], run) for each in wanted if each.name in revisions}


def run_missing(
    wanted: Sequence[Experiment], jobs: int, run: Runner = command, wait: Callable[[float], None] = time.sleep
) -> dict[Experiment, str]:
    """Runs those that have no results yet, in their order, `jobs` at once; those that failed, with the reason.

    Raises CommandError when there are uncommitted changes, or when some of them are running already.
    """
    changed = run("git", "status", "--porcelain", "--", *CODE).strip()
    if changed:
        raise CommandError(f"results are filed under a commit: commit these changes first\n{changed}")
    done = finished(run)
    missing = [each for each in wanted if each.name not in done]
    if not missing:
        return {}
    old = _clear({each.name for each in missing}, run)
    for number, each in enumerate(missing, 1):
        _say(f"queueing {number} of {len(missing)}: {each.label}")
        run(
            "dvc",
            "exp",
            "run",
            "--queue",
            "--name",
            each.name,
            *(word for key in each.overrides for word in ("-S", key)),
        )
    try:
        ended = _watch({each.name: each.label for each in missing}, old, jobs, run, wait)
    except KeyboardInterrupt:
        run("dvc", "queue", "stop", "--kill")
        raise
    done = finished(run)
    return {each: _reason(ended.get(each.name), run) for each in missing if each.name not in done}


def _clear(names: set[str], run: Runner) -> set[str]:
    """Takes what an earlier sitting left of these experiments off the queue; ids of all tasks that remain."""
    tasks, workers = _status(run)
    mine = [task for task in tasks if task.name in names]
    running = [task.name for task in mine if task.state == "Running"]
    if running and workers:
        raise CommandError(f"already running: {', '.join(running)}; wait, or end them with `dvc queue kill`")
    stale = [task.id for task in mine if task.state in ("Queued", "Failed")]
    if stale:
        run("dvc", "queue", "remove", *stale)
    return {task.id for task in tasks} - set(stale)


def _watch(
    labels: dict[str, str], old: set[str], jobs: int, run: Runner, wait: Callable[[float], None]
) -> dict[str, Task]:
    """Waits for the new tasks of these names; each as it ended."""
    started: dict[str, float] = {}
    ended: dict[str, Task] = {}
    idle = 0
    while True:
        tasks, workers = _status(run)
        mine = [task for task in tasks if task.name in labels and task.id not in old]
        for task in mine:
            if task.state == "Running" and task.name not in started:
                started[task.name] = time.monotonic()
                _say(f"started {labels[task.name]}")
            elif task.state not in ("Queued", "Running") and task.name not in ended:
                ended[task.name] = task
                _say(f"{task.state.lower()} {labels[task.name]} ({len(ended)} of {len(labels)})")
                _note_cost(task.name, started.get(task.name))
        if all(task.state not in ("Queued", "Running") for task in mine):
            return ended
        idle = 0 if workers else idle + 1
        if idle > PATIENCE:
            raise CommandError("DVC's queue has tasks and no worker; see .dvc/tmp/exps/celery/*.out")
        if not workers:
            run("dvc", "queue", "start", "--jobs", str(jobs))
        wait(POLL_S)


def _status(run: Runner) -> tuple[list[Task], int]:
    """Tasks of the queue, and how many workers are alive."""
    printed = run("dvc", "queue", "status")
    tasks = []
    for line in printed.splitlines():
        words = line.split()
        if len(words) >= 3 and re.fullmatch(r"[0-9a-f]{7,}", words[0]):
            tasks.append(Task(words[0], words[1], words[-1]))
    workers = re.search(r"(\d+) active, (\d+) idle", printed)
    return tasks, int(workers[1]) + int(workers[2]) if workers else 0


def _reason(task: Task | None, run: Runner) -> str:
    """The last that a failed experiment said."""
    if task is None:
        return "it vanished from DVC's queue"
    lines = [line.strip() for line in run("dvc", "queue", "logs", task.id).splitlines()]
    said = [line for line in lines if re.match(r"(error|\w+Error): ", line)]  # by a stage, else by DVC or whoever
    return (said or [line for line in lines if line] or [task.state])[-1]


def _note_cost(name: str, started: float | None) -> None:
    COSTS.mkdir(parents=True, exist_ok=True)
    seconds = None if started is None else round(time.monotonic() - started)
    (COSTS / f"{name}.json").write_text(json.dumps({"machine": machine(), "time_s": seconds}))


def machine() -> str:
    """What this runs on: system, processor architecture, Python."""
    return f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"


def _read(experiment: Experiment, revision: str, run: Runner) -> Result:
    trackers = json.loads(run("git", "show", f"{revision}:metrics/trackers.json"))
    commit, date = run("git", "show", "--no-patch", "--format=%p %cI", revision).split()[-2:]
    note = COSTS / f"{experiment.name}.json"
    cost = json.loads(note.read_text()) if note.is_file() else {"machine": None, "time_s": None}
    return Result(trackers, commit, date, **cost)


def _say(words: str) -> None:
    print(words, file=sys.stderr, flush=True)
