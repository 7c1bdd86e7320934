"""What a user says about a data set: template boxes, corrections, reference positions (docs/conventions.md)."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io import handwritten
from physpipe.io.annotation_faults import (
    Faults,
    cell_faults,
    correction_faults,
    outside,
    reference_faults,
    template_faults,
)
from physpipe.io.clips import ClipSet

TEMPLATES, CORRECTIONS, REFERENCE = "templates.csv", "corrections.csv", "reference.csv"
COLUMNS = {
    TEMPLATES: ["clip", "object", "frame", "x", "y", "w", "h"],
    CORRECTIONS: ["clip", "object", "frame", "x", "y", "visible"],
    REFERENCE: ["source", "object", "frame", "x", "y"],
}
VISIBLE = {"true": 1, "1": 1, "yes": 1, "false": 0, "0": 0, "no": 0}


class Box(NamedTuple):
    """A user's box around an object: its left and top pixel, width and height in clip pixels."""

    frame: int
    x: float
    y: float
    w: float
    h: float

    @property
    def centre(self) -> tuple[float, float]:
        """(x, y) of the box's middle; a box of one pixel has that pixel's centre."""
        return self.x + (self.w - 1) / 2, self.y + (self.h - 1) / 2


@dataclass(frozen=True)
class Annotations:
    """All that the user gave, in clip frames and clip pixels; a table that was not given has no rows."""

    templates: pd.DataFrame
    """clip, object, frame, x, y, w, h."""
    corrections: pd.DataFrame
    """clip, object, frame, x, y, visible."""
    reference: pd.DataFrame
    """clip, object, frame, x, y, tag; NaN where the object is out of sight."""

    def clips(self) -> list[str]:
        """Sorted names of the clips that the user said anything about."""
        return sorted({str(clip) for table in vars(self).values() for clip in table["clip"]})

    def boxes(self, clip: str, obj: int) -> list[Box]:
        """The boxes around one object, in time order."""
        mine = self.templates[(self.templates["clip"] == clip) & (self.templates["object"] == obj)]
        ordered = mine.sort_values("frame")[list(Box._fields)]
        return [Box(int(row[0]), *map(float, row[1:])) for row in ordered.itertuples(index=False)]

    def objects(self, clip: str) -> int:
        """Number of objects in a clip, K: they are numbered from 0."""
        named = [each.loc[each["clip"] == clip, "object"] for each in vars(self).values()]
        return 1 + max(int(numbers.max()) for numbers in named if len(numbers))


def load(folder: Path, clips: ClipSet) -> Annotations:
    """Reads the tables that `folder` holds.

    Raises InputError naming every bad line of a file at once: a missing column, something that is no number, an
    unknown clip, a frame or a position beyond its clip, a template outside its frame.
    """
    templates = _read(folder / TEMPLATES, clips, template_faults)
    corrections = _read(folder / CORRECTIONS, clips, correction_faults)
    reference = _read(folder / REFERENCE, clips, reference_faults)
    return Annotations(templates, corrections, _on_clips(reference, clips))


def _read(path: Path, clips: ClipSet, find_faults: Callable[[pd.DataFrame, ClipSet], Faults]) -> pd.DataFrame:
    """A checked table of numbers, words only in its first column and in columns that are not ours."""
    columns = COLUMNS[path.name]
    if not path.is_file():
        return pd.DataFrame(columns=columns)
    words = handwritten.rows(path, columns)
    table = words.copy()
    for name in columns[1:]:
        plain = words[name].str.lower().map(VISIBLE) if name == "visible" else words[name]
        table[name] = pd.to_numeric(plain, errors="coerce")
    _refuse(path, cell_faults(table, words) | find_faults(table, clips))
    return table.astype({"object": np.int64, "frame": np.int64})


def _refuse(path: Path, faults: Faults) -> None:
    """Raises one InputError for all faults, with the numbers of their lines in the file."""
    said = []
    for fault, bad in faults.items():
        lines = [str(line) for line in bad.index[bad]]
        if lines:
            more = f" and {len(lines) - 20} more" if len(lines) > 20 else ""
            said.append(f"{fault}: line {', '.join(lines[:20])}{more}")
    if said:
        raise InputError(path, "; ".join(said), "correct these lines")


def _on_clips(reference: pd.DataFrame, clips: ClipSet) -> pd.DataFrame:
    """Rows of recordings as rows of clips.

    An object is out of sight (NaN) where its centre lies outside the clip's frame; a frame that was not decoded
    shows an older picture and has no row.
    """
    shown = clips.table[clips.table["status"] == "ok"]
    given = reference.rename(columns={"frame": "source_frame"})
    rows = shown.merge(given.assign(tag=given.get("tag", "")), on=["source", "source_frame"])
    rows = rows.astype({"x": float, "y": float})
    for clip, mine in rows.groupby("clip"):
        rows.loc[mine.index, ["x", "y"]] = clips.geometry(str(clip)).to_clip(mine[["x", "y"]])
    rows.loc[outside(rows, rows), ["x", "y"]] = np.nan
    return rows[["clip", "object", "frame", "x", "y", "tag"]]
