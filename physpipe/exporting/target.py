"""Where the results of an export go: never over files that are not its own."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physpipe.core.errors import DiskFullError, InputError
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
        raise InputError(
            folder, f"holds other files (no {MANIFEST} of an earlier export)", "give a new folder by --out"
        )
    with writable(folder), replacing_folder(folder) as temporary:
        results.save_json(temporary / MANIFEST, about)
        yield temporary


@contextmanager
def writable(path: Path) -> Iterator[None]:
    """Turns the system's refusal to write at `path` into an InputError."""
    try:
        yield
    except (DiskFullError, FileNotFoundError):
        raise
    except OSError as error:
        reason = f"cannot be written ({error.strerror or error})"
        raise InputError(path, reason, "give another place, or the right to write there") from None
