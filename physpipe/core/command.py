"""Turns `main(name: str, clips: Path, ...)` of a stage into its command line."""

import inspect
import sys
from collections.abc import Callable
from pathlib import Path

from physpipe.core.errors import InputError


def run(main: Callable[..., None]) -> None:
    """Calls `main` with the command line's words; a user's mistake ends as one line, not a traceback."""
    wanted = inspect.signature(main).parameters
    words = sys.argv[1:]
    if len(words) != len(wanted):
        sys.exit(f"{sys.argv[0]} takes {', '.join(wanted)}; got {len(words)} words")
    values = [
        Path(word) if each.annotation is Path else word for word, each in zip(words, wanted.values(), strict=True)
    ]
    try:
        main(*values)
    except InputError as error:
        sys.exit(f"error: {error}")
