"""Experiments: their names, the commands behind them, and what they measured, as Git and DVC keep it."""

import hashlib
import json
import platform
import re
import subprocess
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, NamedTuple

import torch
import yaml

AFTER_TRACKS = ["physpipe/predictors", "physpipe/predictor_learning", "physpipe/finetuning"]
"""Code that only forecasts depend on: trackers need not be measured again when it changes."""
DATA = "data"
PARAMS = "params.yaml"
ALL = ("physpipe", "stages", DATA, "dvc.yaml")
CODE = {"trackers": (*ALL, *(f":(exclude){folder}" for folder in AFTER_TRACKS)), "predictors": ALL}
"""What is measured to the code that it depends on, as Git's path arguments."""
UNREAD = {"trackers": ("predictors", "finetune", "evaluate_predictors", "report"), "predictors": ("finetune",)}
"""What is measured to the sections of params.yaml that it does not depend on, unless a predictor is tuned with it."""
ONE_THREAD = "compute.threads=1"
"""As many experiments run at once as there are cores: on two, 1.5 times as fast as one at a time on two threads."""
COSTS = Path(".scratch/experiments")
Runner = Callable[..., str]


class CommandError(Exception):
    """A command failed; holds what it printed."""


class Experiment(NamedTuple):
    """One variant of the pipeline."""

    label: str
    """Letters, digits, `_` and `-`."""
    overrides: tuple[str, ...]
    """Of params.yaml, as `dvc exp run -S` takes them."""
    measured: str = "trackers"
    """Key of CODE, and the name of the file in `metrics/` that it is run for."""

    @property
    def name(self) -> str:
        """Its name in DVC: other overrides under the same label are another experiment."""
        return f"{self.label}-{hashlib.sha256(chr(10).join(self.overrides).encode()).hexdigest()[:6]}"

    def reads(self, params: Mapping[str, Any]) -> dict[str, Any]:
        """The sections of params.yaml that it depends on, those of other data sets and predictors left out."""
        run = dict(each.split("=", 1) for each in self.overrides)
        unread = UNREAD[self.measured] if run.get("run.finetuned", "[]") == "[]" else ()
        read = {key: section for key, section in params.items() if key not in unread}
        for key, chosen in (("datasets", run.get("run.datasets")), ("predictors", run.get("run.learned"))):
            if key in read and chosen is not None:
                read[key] = {name: params[key].get(name) for name in yaml.safe_load(chosen)}
        return read


class Result(NamedTuple):
    """What one experiment measured."""

    figures: dict[str, dict[str, dict[str, Any]]]
    """The file of `metrics/`: data set to tracker to figures, or to what was learned from to predictor to them."""
    commit: str
    """The last one that changed the code or the params, shortened; not one that only brought film in."""
    finished: str
    """ISO date and time."""
    machine: str | None
    """Null when the experiment was not run from this folder."""
    time_s: float | None
    """Wall-clock seconds, to within a poll of the queue; few where DVC had most stages in its cache."""


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


def on_one_set(
    dataset: str, seed: int, simulated: bool, predictor: str = "", supervised: bool = False, finetuned: bool = False
) -> tuple[str, ...]:
    """Overrides that leave nothing to run but one data set, its trackers and the one predictor that is named."""
    return (
        f"run.datasets=[{dataset}]",
        f"run.simulated=[{dataset if simulated else ''}]",
        f"run.learned=[{predictor}]",
        f"run.supervised=[{dataset if supervised else ''}]",
        f"run.finetuned=[{predictor if finetuned else ''}]",
        f"report.predictor={predictor or 'persistence'}",
        f"compute.seed={seed}",
        ONE_THREAD,
    )


def finished(wanted: Iterable[Experiment], run: Runner = command) -> dict[str, str]:
    """Name to revision of each that has run on today's code, and on today's params as far as it reads them."""
    known = {each.name: each for each in wanted}

    @cache
    def of_today(base: str, measured: str) -> bool:
        return not run("git", "diff", "--name-only", base, "HEAD", "--", *CODE[measured]).strip()

    @cache
    def params(commit: str) -> dict[str, Any]:
        return yaml.safe_load(run("git", "show", f"{commit}:{PARAMS}"))

    revisions = {}
    for line in run("git", "for-each-ref", "--format=%(objectname) %(refname)", "refs/exps").splitlines():
        found = re.fullmatch(r"(\w+) refs/exps/(\w{2})/(\w{38})/(.+)", line)
        if found and found[4] in known:
            base, experiment = found[2] + found[3], known[found[4]]
            same_code = of_today(base, experiment.measured)
            if same_code and experiment.reads(params(base)) == experiment.reads(params("HEAD")):
                revisions[experiment.name] = found[1]
    return revisions


def read_results(wanted: Sequence[Experiment], run: Runner = command) -> dict[Experiment, Result]:
    """Results of those that have finished on today's code."""
    revisions = finished(wanted, run)
    return {each: _read(each, revisions[each.name], run) for each in wanted if each.name in revisions}


def _read(experiment: Experiment, revision: str, run: Runner) -> Result:
    figures = json.loads(run("git", "show", f"{revision}:metrics/{experiment.measured}.json"))
    date = run("git", "show", "--no-patch", "--format=%cI", revision).split()[-1]
    code = (PARAMS, *(path for path in CODE[experiment.measured] if path != DATA))
    commit = run("git", "log", "-1", "--format=%h", f"{revision}^", "--", *code).strip()
    note = COSTS / f"{experiment.name}.json"
    cost = json.loads(note.read_text()) if note.is_file() else {"machine": None, "time_s": None}
    return Result(figures, commit, date, **cost)


def about(found: Mapping[int, Result]) -> dict[str, Any]:
    """What to say of a row that comes of these results, by seed: commit, seeds, machine, finished, time_s."""
    times = [each.time_s for each in found.values()]
    return {
        "commit": ", ".join(sorted({each.commit for each in found.values()})),
        "seeds": sorted(found),
        "machine": " and ".join(sorted({each.machine or "elsewhere" for each in found.values()})),
        "finished": max(each.finished for each in found.values()),
        "time_s": None if None in times else max(time for time in times if time is not None),
    }


def note_cost(name: str, time_s: float | None) -> None:
    """Keeps what the experiment `name`, which ran here, has cost."""
    COSTS.mkdir(parents=True, exist_ok=True)
    (COSTS / f"{name}.json").write_text(json.dumps({"machine": machine(), "time_s": time_s}))


def machine() -> str:
    """What this runs on: system, processor and its vector instructions, Python."""
    vectors = torch.backends.cpu.get_cpu_capability()
    return f"{platform.system()} {platform.machine()} {vectors}, Python {platform.python_version()}"
