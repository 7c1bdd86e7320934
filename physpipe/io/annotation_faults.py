"""What can be wrong with a line that a user wrote about a data set."""

import numpy as np
import pandas as pd

from physpipe.io.clips import ClipSet

SMALLEST = 3
"""Pixels that a template must span: fewer hold no pattern."""
Faults = dict[str, pd.Series]
"""What is wrong -> which rows are, as a boolean column."""


def cell_faults(table: pd.DataFrame, words: pd.DataFrame) -> Faults:
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


def template_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    """Boxes without a place in their clip's frame."""
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


def correction_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    """Corrections without a place in their clip's frame."""
    faults, size = _clip_faults(table, clips)
    visible = table["visible"] == 1
    return faults | {
        "visible without a position": visible & table[["x", "y"]].isna().any(axis=1),
        "position outside the frame (give clip pixels)": visible & outside(table, size),
    }


def reference_faults(table: pd.DataFrame, clips: ClipSet) -> Faults:
    """A table that is of no recording of the clips; one that is of others, too, will do."""
    known = set(clips.table["source"])
    none = not table["source"].isin(known).any()
    return {f"`source` is none of the clips' recordings {sorted(known)[:3]}": pd.Series(none, index=table.index)}


def outside(table: pd.DataFrame, size: pd.DataFrame) -> pd.Series:
    """Rows whose position lies beyond the frame of their `width` and `height` in `size`."""
    x, y = table["x"], table["y"]
    return (x < -0.5) | (y < -0.5) | (x > size["width"] - 0.5) | (y > size["height"] - 0.5)
