"""Runs experiments through DVC's queue.

Each runs in a copy of the project that shares its cache, so what it does not change runs once. Results stay in Git
(`dvc exp show`): an experiment that has some for today's code is not run again, on whatever commit it ran.
`dvc config --local cache.type symlink` spares every copy its own files.
"""

import re
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from experiments.records import ALL, CommandError, Experiment, Runner, command, finished, note_cost

POLL_S = 30.0
"""Between looks at the queue: each takes DVC one to two seconds of a core, and experiments minutes."""
PREDICTORS = "data/predictors"
"""Folder that the report depends on, which nothing makes in an experiment that learns no predictor."""
PATIENCE = 6
"""Polls without a worker, or answers of DVC that failed, after which its queue counts as broken."""


class Task(NamedTuple):
    """A line of `dvc queue status`."""

    id: str
    name: str
    state: str


def run_missing(
    wanted: Sequence[Experiment], jobs: int, run: Runner = command, wait: Callable[[float], None] = time.sleep
) -> dict[Experiment, str]:
    """Runs those that have no results yet, in their order, `jobs` at once; those that failed, with the reason.

    Raises CommandError when there are uncommitted changes, or when some of them are running already.
    """
    changed = run("git", "status", "--porcelain", "--", *ALL).strip()
    if changed:
        raise CommandError(f"results are filed under a commit: commit these changes first\n{changed}")
    done = finished(wanted, run)
    missing = [each for each in wanted if each.name not in done]
    if not missing:
        return {}
    Path(PREDICTORS).mkdir(parents=True, exist_ok=True)
    old = _clear({each.name for each in missing}, run, wait)
    for number, each in enumerate(missing, 1):
        _say(f"queueing {number} of {len(missing)}: {each.label}")
        run(
            "dvc",
            "exp",
            "run",
            "--queue",
            "--name",
            each.name,
            "--copy-paths",
            PREDICTORS,
            *(word for key in each.overrides for word in ("-S", key)),
        )
    try:
        ended = _watch({each.name: each.label for each in missing}, old, jobs, run, wait)
    except KeyboardInterrupt:
        run("dvc", "queue", "stop", "--kill")
        raise
    done = finished(missing, run)
    return {each: _reason(ended.get(each.name), run) for each in missing if each.name not in done}


def _clear(names: set[str], run: Runner, wait: Callable[[float], None]) -> set[str]:
    """Takes what an earlier sitting left of these experiments off the queue; ids of all tasks that remain."""
    tasks, workers = _status(run, wait)
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
        tasks, workers = _status(run, wait)
        mine = [task for task in tasks if task.name in labels and task.id not in old]
        for task in mine:
            if task.state == "Running" and task.name not in started:
                started[task.name] = time.monotonic()
                _say(f"started {labels[task.name]}")
            elif task.state not in ("Queued", "Running") and task.name not in ended:
                ended[task.name] = task
                _say(f"{task.state.lower()} {labels[task.name]} ({len(ended)} of {len(labels)})")
                seconds = round(time.monotonic() - started[task.name]) if task.name in started else None
                note_cost(task.name, seconds)
        if all(task.state not in ("Queued", "Running") for task in mine):
            return ended
        idle = 0 if workers else idle + 1
        if idle > PATIENCE:
            raise CommandError("DVC's queue has tasks and no worker; see .dvc/tmp/exps/celery/*.out")
        if not workers:
            run("dvc", "queue", "start", "--jobs", str(jobs))
        wait(POLL_S)


def _status(run: Runner, wait: Callable[[float], None]) -> tuple[list[Task], int]:
    """Tasks of the queue, and how many workers are alive."""
    printed = _printed(run, wait)
    tasks = []
    for line in printed.splitlines():
        words = line.split()
        if len(words) >= 3 and re.fullmatch(r"[0-9a-f]{7,}", words[0]):
            tasks.append(Task(words[0], words[1], words[-1]))
    workers = re.search(r"(\d+) active, (\d+) idle", printed)
    return tasks, int(workers[1]) + int(workers[2]) if workers else 0


def _printed(run: Runner, wait: Callable[[float], None]) -> str:
    """What `dvc queue status` says; it fails now and then, where a worker is just writing what it reads."""
    for _ in range(PATIENCE):
        try:
            return run("dvc", "queue", "status")
        except CommandError:
            wait(POLL_S)
    return run("dvc", "queue", "status")


def _reason(task: Task | None, run: Runner) -> str:
    """The last that a failed experiment said."""
    if task is None:
        return "it vanished from DVC's queue"
    lines = [line.strip() for line in run("dvc", "queue", "logs", task.id).splitlines()]
    said = [line for line in lines if re.match(r"(error|\w+Error): ", line)]  # by a stage, else by DVC or whoever
    return (said or [line for line in lines if line] or [task.state])[-1]


def _say(words: str) -> None:
    print(words, file=sys.stderr, flush=True)
