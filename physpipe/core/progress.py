"""Progress with a remaining-time estimate; one place, so that every stage reports alike."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

Item = TypeVar("Item")


def progress(items: Iterable[Item], what: str, total: int | None = None, start: int = 0) -> Iterator[Item]:
    """Yields `items`, showing count, rate and ETA on stderr (seldom when it is a log file)."""
    every = 0.5 if sys.stderr.isatty() else 15.0
    yield from tqdm(items, desc=what, total=total, initial=start, mininterval=every, dynamic_ncols=True)
