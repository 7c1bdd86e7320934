"""A set's own division into train, valid and test: `splits.csv` beside its film (docs/conventions.md)."""

from collections.abc import Iterable
from pathlib import Path, PurePosixPath

import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io import folders, handwritten
from physpipe.io.clips import SPLITS, Split

SPLIT_FILE = "splits.csv"
COLUMNS = ["recording", "split"]


def read(folder: Path, recordings: Iterable[Path]) -> dict[str, Split] | None:
    """Source to split of every one of the `recordings` of `folder`; None where no split file lies in it.

    A recording goes by its path inside `folder`, with or without its suffix. Raises InputError naming every bad line at
    once (an unknown recording, an unknown split, two splits for one recording), and every recording without a line:
    where a set is divided, chance must not decide whether film is for learning or for testing.
    """
    path = folder / SPLIT_FILE
    if not path.is_file():
        return None
    rows = handwritten.rows(path, COLUMNS)
    sources = _sources(folder, recordings)
    found = [sources.get(str(PurePosixPath(name.replace("\\", "/")))) for name in rows["recording"]]
    splits, faults = _decided(rows, found)
    faults += [f"no line for the recording `{each}`" for each in sorted({*sources.values()} - {*found})]
    if faults:
        mend = f"give every recording one line: its path inside {folder}, a comma, and one of {', '.join(SPLITS)}"
        raise InputError(path, "".join(f"\n  {each}" for each in faults) + "\n", mend)
    return splits


def _decided(rows: pd.DataFrame, found: list[str | None]) -> tuple[dict[str, Split], list[str]]:
    """Source to split, and what is wrong with the rows, of which `found` are the sources."""
    decided: dict[str, tuple[Split, int]] = {}
    faults = []
    for line, name, word, source in zip(rows.index, rows["recording"], rows["split"], found, strict=True):
        split = next((each for each in SPLITS if each == word), None)
        if source is None:
            faults.append(f"line {line}: no recording `{name}`")
        if split is None:
            faults.append(f"line {line}: no split `{word}`")
        if source is not None and split is not None:
            before, where = decided.setdefault(source, (split, line))
            if before != split:
                faults.append(f"line {line}: `{name}` is `{before}` in line {where} and `{split}` here")
    return {source: split for source, (split, _) in decided.items()}, faults


def _sources(folder: Path, recordings: Iterable[Path]) -> dict[str, str]:
    """What a recording may be called in the file, to its source."""
    named = [(folders.source(each, folder), folders.stem(each, folder)) for each in recordings]
    return {stem: source for source, stem in named} | {source: source for source, _ in named}
