"""New film into the project: recordings, and what is known about them, each to its place."""

import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

import pandas as pd

from physpipe.core.errors import InputError
from physpipe.core.progress import progress
from physpipe.io import folders, handwritten, results, split_file
from physpipe.io.annotations import COLUMNS, CORRECTIONS, REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing_folder

POSITIONS = ["frame", "x", "y"]
BLOCK = 2**20
"""Bytes copied at a time."""


def copy_film(folder: Path, raw: Path, annotations: Path) -> list[Path]:
    """Copies the recordings of `folder` and its split file to `raw`, its tables to `annotations`; returns the former.

    Film keeps its folders. Tables of annotations go where ingest does not look; templates and corrections that are
    not given are started. Reference positions in `<stem>.ref.csv` beside a recording (frame in decode order, x, y in
    source pixels) become reference.csv. Raises InputError when there is nothing to copy, a table lacks a column, the
    split file has a bad line, references come in both ways, or a target exists.
    """
    found = folders.recordings(folder)
    for target in (raw, annotations):
        if target.exists():
            raise InputError(target, "exists already", "choose another name, or remove it first")
    split_file.read(folder, found)
    given = [folder / name for name in COLUMNS if (folder / name).is_file()]
    for path in given:
        handwritten.rows(path, COLUMNS[path.name])
    references = _references(folder, found)
    with replacing_folder(annotations) as tables, replacing_folder(raw) as film:
        for name in (TEMPLATES, CORRECTIONS):
            results.save_csv(tables / name, pd.DataFrame(columns=COLUMNS[name]))
        if references:
            results.save_csv(tables / REFERENCE, pd.concat(references))
        for path in given:
            shutil.copyfile(path, tables / path.name)
        _copy(folder, found, film)
    return found


def _copy(folder: Path, found: Iterable[Path], film: Path) -> None:
    recorded = [file for path in found for file in (folders.images(path) if path.is_dir() else [path])]
    files = [*recorded, *folder.glob(split_file.SPLIT_FILE)]
    blocks = sum(-(-file.stat().st_size // BLOCK) for file in files)
    copying = (block for file in files for block in _copied(file, film / file.relative_to(folder)))
    for _ in progress(copying, "copy film (MiB)", blocks):
        pass


def _copied(file: Path, target: Path) -> Iterator[int]:
    """Copies a file, and yields the bytes of each block that is done."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with file.open("rb") as source, target.open("wb") as copy:
        while block := source.read(BLOCK):
            yield copy.write(block)


def _references(folder: Path, found: Iterable[Path]) -> list[pd.DataFrame]:
    """Rows of reference.csv from every `<stem>.ref.csv`."""
    references = []
    for path in found:
        beside = path.with_name(f"{path.name if path.is_dir() else path.stem}.ref.csv")
        if not beside.is_file():
            continue
        if (folder / REFERENCE).is_file():
            raise InputError(beside, f"{folder / REFERENCE} gives reference positions too", "leave one of the two")
        rows = handwritten.rows(beside, POSITIONS).assign(source=folders.source(path, folder), object=0)
        references.append(rows[COLUMNS[REFERENCE]])
    return references
