"""Which command makes what the pipeline has not made yet."""

from pathlib import Path
from typing import Any

from physpipe.commands.places import DATA, RAW
from physpipe.core.errors import InputError
from physpipe.core.params import read_value


def made(path: Path, name: str, stage: str = "") -> Path:
    """`path`, if it is there; raises InputError otherwise, with the command that makes it for data set `name`.

    `stage` is the last one that has to run, all by default.
    """
    if path.exists():
        return path
    if not path.absolute().is_relative_to(DATA.absolute()):
        raise InputError(path, "no such file", "give one that is there")
    raise InputError(path, "no such file", f"run {_film_first(name)}`{running(name, stage)}`, which makes it")


def running(name: str, stage: str = "") -> str:
    """What makes the results of data set `name`, or those of one stage; `dvc repro` knows the sets of `run` alone."""
    target = f" {stage}@{name}" if stage else ""
    return f"dvc repro{target}" if name in read_value("run.datasets") else f"{alone(name)}{target}"


def alone(name: str) -> str:
    """A run of data set `name` and no other."""
    section: Any = read_value(f"datasets.{name}")
    exact = f"[{name}]" if "simulate" in section else "[]"
    return f'dvc exp run -S "run.datasets=[{name}]" -S "run.simulated={exact}" -S "run.supervised={exact}"'


def _film_first(name: str) -> str:
    """`add`, where the set is a filmed one, and there is neither film nor DVC's note of it."""
    lacks = not any(path.exists() for path in (RAW / name, RAW / f"{name}.dvc"))
    return f"`physpipe add {name} FOLDER`, then " if lacks and "simulate" not in read_value(f"datasets.{name}") else ""
