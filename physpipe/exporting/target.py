"""Where the results of an export go: never over files that are not its own."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physpipe.core.errors import InputError
from physpipe.io import results
from physpipe.io.atomic import replacing_folder

MANIFEST = "about.json"
"""What an exported folder holds; it lists the others, which alone may be replaced."""
MARK = {"written_by": "physpipe"}
"""What tells our manifest from another program's file of that name."""
NAMED = 3
"""Foreign files that a refusal names, at most."""


@contextmanager
def exported(folder: Path, about: dict[str, Any]) -> Iterator[Path]:
    """A folder to write into, which takes the place of an earlier export when the block ends well.

    Raises InputError for a folder that holds anything else, or that cannot be written.
    """
    _refuse_foreign(folder)
    with writable(folder), replacing_folder(folder) as temporary:
        yield temporary
        results.save_json(temporary / MANIFEST, about | MARK | {"files": _contents(temporary)})
        _refuse_foreign(folder)  # again: films take minutes, in which somebody may put something there


def _refuse_foreign(folder: Path) -> None:
    held = _contents(folder)
    ours = _listed(folder / MANIFEST)
    if held and ours is None:
        raise InputError(folder, f"holds other files, and no {MANIFEST} of an export", "give a new folder by --out")
    foreign = [name for name in held if name not in {MANIFEST, *(ours or [])}]
    if foreign:
        named = ", ".join(foreign[:NAMED]) + (f" and {len(foreign) - NAMED} more" if len(foreign) > NAMED else "")
        reason = f"holds what is not of the earlier export: {named}"
        raise InputError(folder, reason, "move it elsewhere, or give a new folder by --out")


def _contents(folder: Path) -> list[str]:
    """Everything in it but plain folders, by its path inside; a link counts, wherever it leads."""
    inside = folder.rglob("*") if folder.is_dir() else ()
    return sorted(each.relative_to(folder).as_posix() for each in inside if each.is_symlink() or not each.is_dir())


def _listed(manifest: Path) -> list[str] | None:
    """The files that it lists; None where it is absent, or another program's."""
    try:
        about = json.loads(manifest.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    ours = isinstance(about, dict) and MARK.items() <= about.items() and isinstance(about.get("files"), list)
    return about["files"] if ours else None


@contextmanager
def writable(path: Path) -> Iterator[None]:
    """Turns the system's refusal to write at `path` into an InputError; other errors stay as they are."""
    try:
        yield
    except OSError as error:
        place, refused = path.absolute(), Path(error.filename or "").absolute()
        if not (error.filename and (refused in place.parents or refused.is_relative_to(place.parent))):
            raise
        above = f": {error.filename}" if refused in place.parents else ""
        reason = f"cannot be written ({error.strerror}{above})"
        raise InputError(path, reason, "give another place, or get the right to write there") from None
