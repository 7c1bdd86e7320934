"""What `dvc repro` would run again, and why."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from physpipe.core.errors import InputError
from physpipe.health.asking import Ask
from physpipe.health.finding import Finding

SHOWN = 6
"""Paths named of each kind, at most."""
LOCK, RUNNING = Path("dvc.lock"), Path(".dvc/tmp/rwlock")
Changes = Sequence[Any]
"""What `dvc status --json` says of one stage: words, or {kind: {path: how}}."""


def check(ask: Ask) -> Iterator[Finding]:
    """DVC's version and state, then a line a stage that would run."""
    try:
        yield Finding("ok", f"DVC {ask('dvc', '--version').strip()}")
        yield from _locks()
        status = json.loads(ask("dvc", "status", "--json"))
    except InputError as error:
        yield Finding("problem", f"{error.where}: {error.reason}", error.mend)
        return
    added = [name for name in status if name.endswith(".dvc")]
    for name in added:
        yield Finding(
            "warning", f"{name}: the film differs from what DVC keeps ({reason(status[name], ())})", _film(name)
        )
    stages = {name: changes for name, changes in status.items() if name not in added}
    yield from _stages(stages)


def _locks() -> Iterator[Finding]:
    if RUNNING.is_file() and not RUNNING.read_text().strip():
        yield Finding("problem", f"{RUNNING} is empty: DVC was killed, and now refuses to run", f"remove {RUNNING}")


def _film(name: str) -> str:
    data = name.removesuffix(".dvc")
    return f"`dvc add {data}` keeps the new state, `dvc checkout {name}` brings back the old one"


def _stages(stages: Mapping[str, Changes]) -> Iterator[Finding]:
    if not stages:
        yield Finding("ok", "all stages are up to date: nothing would run")
        return
    locked = _locked()
    made = [path for stage in locked.values() for path in _paths(stage, "outs")]
    alike: dict[tuple[str, str], list[str]] = {}
    for name, changes in stages.items():
        stage, _, item = name.partition("@")
        alike.setdefault((stage, _without(item.partition("-")[0], reason(changes, made))), []).append(item)
    for (stage, why), items in alike.items():
        yield Finding("runs", f"{stage}{'@' if any(items) else ''}{', '.join(items)}: {why}")
    behind = following(stages, locked)
    if behind:
        yield Finding("runs", f"and, if what they read comes out otherwise: {', '.join(behind)}")


def reason(changes: Changes, made: Sequence[str]) -> str:
    """What changed, in words: `code physpipe/io; numbers tracker.lock; no data/clips/bowls`.

    Inputs that are missing go without saying where a stage makes them: `made` are all such paths.
    """
    found: dict[str, list[str]] = {}
    for change in changes:
        if isinstance(change, str):
            found[change] = []
            continue
        for kind, paths in change.items():
            for path, how in paths.items():
                if isinstance(how, dict):
                    found.setdefault("numbers", []).extend(how)
                elif not (how == "deleted" and kind == "changed deps" and _touch([path], made)):
                    found.setdefault(_word(kind, path, how), []).append(path)
    if not found:
        return "its inputs are missing"
    return "; ".join(f"{word} {_listed(paths)}".strip() for word, paths in found.items())


def _without(dataset: str, text: str) -> str:
    """`text` with a star for the data set's name, so that sets of which the same is said stand together."""
    return re.sub(rf"\b{re.escape(dataset)}\b", "*", text) if dataset else text


def _listed(paths: list[str]) -> str:
    more = len(paths) - SHOWN
    return ", ".join(paths[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def _word(kind: str, path: str, how: str) -> str:
    if how in ("deleted", "not in cache"):
        return "no"
    if kind == "changed outs":
        return "changed by hand"
    return "code" if path.startswith(("physpipe/", "stages/")) else "other input"


def following(stages: Mapping[str, Changes], locked: Mapping[str, Any]) -> list[str]:
    """Stages of the lock file that read what `stages` make, directly or not, and are none of them."""
    made = [path for name in stages for path in _paths(locked.get(name, {}), "outs")]
    found: list[str] = []
    grown = True
    while grown:
        new = [
            name
            for name, stage in locked.items()
            if name not in stages and name not in found and _touch(_paths(stage, "deps"), made)
        ]
        found += new
        made += [path for name in new for path in _paths(locked[name], "outs")]
        grown = bool(new)
    return found


def _locked() -> Mapping[str, Any]:
    return yaml.safe_load(LOCK.read_text(encoding="utf-8"))["stages"] if LOCK.is_file() else {}


def _paths(stage: Mapping[str, Any], kind: str) -> list[str]:
    return [each["path"] for each in stage.get(kind, [])]


def _touch(deps: Sequence[str], outs: Sequence[str]) -> bool:
    """Whether any of `deps` is, holds or lies in any of `outs`."""
    return any(f"{dep}/".startswith(f"{out}/") or f"{out}/".startswith(f"{dep}/") for dep in deps for out in outs)
