"""What a user says about a data set: template boxes, corrections, reference positions (docs/conventions.md)."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io import handwritten
from physpipe.io.clips import ClipSet

TEMPLATES, CORRECTIONS, REFERENCE = "templates.csv", "corrections.csv", "reference.csv"
COLUMNS = {
    TEMPLATES: ["clip", "object", "frame", "x", "y", "w", "h"],
    CORRECTIONS: ["clip", "object", "frame", "x", "y", "visible"],
    REFERENCE: ["source", "object", "frame", "x", "y"],
}
SMALLEST = 3
"""Pixels that a template must span: fewer hold no pattern."""
VISIBLE = {"true": 1, "1": 1, "yes": 1, "false": 0, "0": 0, "no": 0}
Faults = dict[str, pd.Series]
"""What is wrong -> which rows are, as a boolean column."""


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
    templates = _read(folder / TEMPLATES, clips, _template_faults)
    corrections = _read(folder / CORRECTIONS, clips, _correction_faults)
    reference = _read(folder / REFERENCE, clips, _reference_faults)
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
    _refuse(path, _cell_faults(table, words) | find_faults(table, clips))
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


def _cell_faults(table: pd.DataFrame, words: pd.DataFrame) -> Faults:
    """Cells that cannot be read; x and y may be blank together, where an object is out of sight."""
    faults = {}
    for name in [name for name in ("object", "frame", "x", "y", "w", "h") if name in table]:
        blank = (words["x"] == "") & (words["y"] == "") if name in ("x", "y") else False
        faults[f"`{name}` is not a number"] = ~(np.isfinite(table[name]) | blank)
    for name in ("object", "frame"):
        faults[f"`{name}` is not 0, 1, 2 ..."] = (table[name] < 0) | (table[name] % 1 > 0)
    if "visible" in table:
        faults["`visible` is not true or false"] = table["visible"].isna()
    faults["repeats an earlier line"] = table.duplicated([table.columns[0], "object", "frame"])
    return faults


def _clip_faults(table: pd.DataFrame, clips: ClipSet) -> tuple[Faults, pd.DataFrame]:
    """Rows of no clip or no frame of it, and the size of each row's clip: frames, width, height."""
    by_clip = clips.table.groupby("clip")
    size = by_clip[["width", "height"]].first().assign(frames=by_clip.size())
    size = size.reindex(table["clip"]).set_index(table.index)
    return {"no such clip": size["frames"].isna(), "frame beyond the clip": table["frame"] >= size["frames"]}, size


def _template_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    faults, size = _clip_faults(table, clips)
    larger = (table["w"] > size["width"]) | (table["h"] > size["height"])
    right, bottom = table["x"] + table["w"], table["y"] + table["h"]
    outside = (table["x"] < 0) | (table["y"] < 0) | (right > size["width"]) | (bottom > size["height"])
    return faults | {
        "template without a position": table[["x", "y"]].isna().any(axis=1),
        f"template smaller than {SMALLEST} pixels": (table["w"] < SMALLEST) | (table["h"] < SMALLEST),
        "template larger than the clip's frame": larger,
        "template outside the frame": outside & ~larger,
    }


def _correction_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    faults, size = _clip_faults(table, clips)
    visible = table["visible"] == 1
    return faults | {
        "visible without a position": visible & table[["x", "y"]].isna().any(axis=1),
        "position outside the frame (give clip pixels)": visible & _outside(table, size),
    }


def _reference_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    known = set(clips.table["source"])
    none = not table["source"].isin(known).any()
    return {f"`source` is none of the clips' recordings {sorted(known)[:3]}": pd.Series(none, index=table.index)}


def _outside(table: pd.DataFrame, size: pd.DataFrame) -> pd.Series:
    x, y = table["x"], table["y"]
    return (x < -0.5) | (y < -0.5) | (x > size["width"] - 0.5) | (y > size["height"] - 0.5)


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
    rows.loc[_outside(rows, rows), ["x", "y"]] = np.nan
    return rows[["clip", "object", "frame", "x", "y", "tag"]]
