"""The project's params, film and Git state."""

from collections.abc import Iterator
from pathlib import Path

from physpipe.core.determinism import ComputeParams
from physpipe.core.errors import InputError
from physpipe.core.parallel import worker_count
from physpipe.core.params import PARAMS, Section, read
from physpipe.finetuning.tuning import FinetuneParams
from physpipe.health.asking import Ask
from physpipe.health.finding import Finding
from physpipe.health.sections import OF_A_SET
from physpipe.health.wording import counted
from physpipe.io import folders
from physpipe.report.params import ReportParams
from physpipe.report.run import RunParams
from physpipe.tracker_learning.recipe import TrackerParams

WHOLE: dict[str, type[Section]] = {
    "run": RunParams,
    "compute": ComputeParams,
    "tracker": TrackerParams,
    "finetune": FinetuneParams,
    "report": ReportParams,
}
AUTHOR = ("user.name", "user.email")


def check(ask: Ask) -> Iterator[Finding]:
    """Everything about the project in the current folder but its pipeline."""
    if not PARAMS.is_file():
        yield Finding("problem", f"no {PARAMS} in {Path.cwd()}", "run from the project's root")
        return
    yield from _sections(WHOLE)
    try:
        run, compute = read("run", RunParams), read("compute", ComputeParams)
    except InputError:
        return  # said already
    for name in run.datasets:
        yield from _sections({f"datasets.{name}.{part}": kind for part, kind in OF_A_SET.items()})
        if name not in run.simulated:
            yield _film(name)
    if compute.threads > worker_count():
        text = f"`compute.threads` is {compute.threads}, and there are {worker_count()} cores for us"
        yield Finding("warning", text, f"set it to {worker_count()}; metrics then differ in the last digits")
    yield _branch(ask)
    yield from _author(ask)


def _sections(kinds: dict[str, type[Section]]) -> Iterator[Finding]:
    faults = []
    for section, kind in kinds.items():
        try:
            read(section, kind)
        except InputError as error:
            faults.append(Finding("problem", f"{error.where}: {error.reason}", error.mend))
    yield from faults
    if not faults:
        yield Finding("ok", f"{PARAMS}: {', '.join(kinds)}")


def _film(name: str) -> Finding:
    raw = Path("data/raw") / name
    try:
        return Finding("ok", f"film of {name}: {counted(len(folders.recordings(raw)), 'recording')} in {raw}")
    except InputError as error:
        mend = f"`dvc checkout {raw}.dvc` brings it back; a new set comes by `physpipe add {name} FOLDER`"
        return Finding("problem", f"film of {name}: {error.where}: {error.reason}", mend)


def _branch(ask: Ask) -> Finding:
    try:
        branch = ask("git", "rev-parse", "--abbrev-ref", "HEAD").strip()
    except InputError as error:
        text = f"{error.where}: {error.reason}; without Git there are no experiments to compare"
        return Finding("warning", text, "`git init`, or `dvc config core.no_scm true`")
    if branch == "HEAD":
        text = "Git is on no branch, as after an experiment that was killed: commits would get lost"
        return Finding("warning", text, "`git switch main`, or the branch that you were on")
    return Finding("ok", f"Git is on {branch}")


def _author(ask: Ask) -> Iterator[Finding]:
    """Nothing where Git is absent, which its branch has said."""
    for key in AUTHOR:
        try:
            ask("git", "config", key)
        except InputError as error:
            if error.where != "git":
                text = f"Git has no `{key}`, and `dvc exp run` keeps experiments as commits, which name their author"
                yield Finding("warning", text, f"`git config --global {key} ...`")
