"""New film into the project: recordings copied, reference positions converted."""

import shutil
from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io import results, video
from physpipe.io.annotations import COLUMNS, CORRECTIONS, REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing_folder


def copy_film(folder: Path, raw: Path, annotations: Path) -> list[Path]:
    """Copies the recordings of `folder` to `raw` and starts the tables of `annotations`; returns the recordings.

    Reference positions in `<stem>.ref.csv` beside a recording (frame in decode order, x, y in source pixels) become
    reference.csv. Raises InputError when there is nothing to copy, a table lacks a column, or a target exists.
    """
    found = video.recordings(folder)
    for target in (raw, annotations):
        if target.exists():
            raise InputError(target, "exists already", "choose another name, or remove it first")
    references = [_reference(path) for path in found if _reference_path(path).is_file()]
    with replacing_folder(annotations) as tables, replacing_folder(raw) as film:
        for name in (TEMPLATES, CORRECTIONS):
            results.save_csv(tables / name, pd.DataFrame(columns=COLUMNS[name]))
        if references:
            results.save_csv(tables / REFERENCE, pd.concat(references))
        _copy(found, film)
    return found


def _copy(found: Iterable[Path], film: Path) -> None:
    for path in found:
        if path.is_dir():
            (film / path.name).mkdir()
        for file in video.images(path) if path.is_dir() else [path]:
            shutil.copyfile(file, film / file.relative_to(path.parent))


def _reference_path(path: Path) -> Path:
    return path.with_name(f"{path.name if path.is_dir() else path.stem}.ref.csv")


def _reference(path: Path) -> pd.DataFrame:
    table = pd.read_csv(_reference_path(path))
    missing = [name for name in ("frame", "x", "y") if name not in table]
    if missing:
        raise InputError(_reference_path(path), f"lacks column(s) {', '.join(missing)}", "begin it with frame,x,y")
    return table.assign(source=path.name, object=0)[COLUMNS[REFERENCE]]
