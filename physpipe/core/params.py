"""Strict reader of params.yaml: no defaults, no unknown keys, typed values."""

import difflib
import os
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

import physpipe
from physpipe.core.errors import InputError

PARAMS = Path("params.yaml")


class Section(BaseModel):
    """Base of every params class: frozen, and any key it does not name is an error.

    Numbers may arrive as strings: `dvc exp run -S lr=1e-5` writes `1e-05`, which
    PyYAML reads as a string and pydantic turns back into the number.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


Params = TypeVar("Params", bound=Section)


def read(section: str, kind: type[Params], path: Path = PARAMS) -> Params:
    """The section `a.b.c` of params.yaml as a checked `kind`.

    Raises InputError naming the key, the reason and the mend (the nearest known key for a misspelt one).
    """
    _refuse_foreign_library()
    try:
        return kind.model_validate(_find(section, path))
    except ValidationError as error:
        raise InputError(path, _describe(error, section, kind), "correct params.yaml") from None


def read_value(section: str, path: Path = PARAMS) -> Any:
    """The bare value (a list, a number) at `section`; raises InputError when it is absent."""
    _refuse_foreign_library()
    return _find(section, path)


def _find(section: str, path: Path) -> Any:
    try:
        node = yaml.safe_load(path.read_text())
    except FileNotFoundError:
        raise InputError(path, "no such file", "run from the project's root") from None
    except yaml.YAMLError as error:
        raise InputError(path, f"not valid YAML ({error})", "correct the line it names") from None
    done: list[str] = []
    for key in section.split("."):
        if not isinstance(node, dict) or key not in node:
            known = list(node) if isinstance(node, dict) else []
            raise InputError(path, f"no key `{'.'.join([*done, key])}`{nearest(key, known)}", "add the key")
        node = node[key]
        done.append(key)
    return node


def _describe(error: ValidationError, section: str, kind: type[Section]) -> str:
    parts = []
    for problem in error.errors():
        key = ".".join([section, *map(str, problem["loc"])])
        hint = ""
        if problem["type"] == "extra_forbidden":
            hint = nearest(str(problem["loc"][-1]), list(_fields_at(kind, problem["loc"][:-1])))
        parts.append(f"`{key}`: {problem['msg']}, got {problem['input']!r}{hint}")
    return "; ".join(parts)


def _fields_at(kind: type[BaseModel], location: tuple[int | str, ...]) -> list[str]:
    """Names of the fields of the (nested) params class at `location`."""
    for key in location:
        field = kind.model_fields.get(str(key))
        if field is None or not (isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel)):
            return []
        kind = field.annotation
    return list(kind.model_fields)


def nearest(word: str, known: list[str]) -> str:
    """The hint " (did you mean `...`?)" for a misspelt `word`, empty where none of `known` is like it."""
    close = difflib.get_close_matches(word, known, n=1)
    return f" (did you mean `{close[0]}`?)" if close else ""


def _refuse_foreign_library() -> None:
    """An experiment that runs in a copy of the project must not run the original's code."""
    root = os.environ.get("DVC_ROOT")
    library = Path(physpipe.__file__).resolve()
    if root and not library.is_relative_to(Path(root).resolve()):
        raise InputError(library, f"the library lies outside {root}", "run stages as `python -m stages.<name>`")
