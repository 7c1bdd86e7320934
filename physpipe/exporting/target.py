"""Where the results of an export go: never over files that are not its own."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physpipe.core.errors import InputError
from physpipe.io import results
from physpipe.io.atomic import replacing_folder

MANIFEST = "about.json"
"""What an exported folder holds; a folder with it may be replaced."""


@contextmanager
def exported(folder: Path, about: dict[str, Any]) -> Iterator[Path]:
    """A folder to write into, which takes the place of an earlier export when the block ends well.

    Raises InputError for a folder that holds anything else, or that cannot be written.
    """
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MANIFEST).is_file():
        raise InputError(folder, f"holds other files, and no {MANIFEST} of an export", "give a new folder by --out")
    with writable(folder), replacing_folder(folder) as temporary:
        results.save_json(temporary / MANIFEST, about)
        yield temporary


@contextmanager
def writable(path: Path) -> Iterator[None]:
    """Turns the system's refusal to write at `path` into an InputError; other errors stay as they are."""
    try:
        yield
    except OSError as error:
        place, refused = path.absolute(), Path(error.filename or "").absolute()
        if not (error.filename and (refused in place.parents or refused.is_relative_to(place.parent))):
            raise
        reason = f"cannot be written ({error.strerror})"
        raise InputError(path, reason, "give another place, or get the right to write there") from None
