"""What was said about one clip, as page and server tell it each other, and as rows of the tables of annotations."""

import hashlib
from typing import Any

import pandas as pd
from pydantic import BaseModel, ConfigDict, Field

from physpipe.io.annotations import COLUMNS, CORRECTIONS, TEMPLATES, Annotations

MOST_OBJECTS = 1000
"""Larger numbers are a slip: every object below the highest number gets rows in the truth."""
INTERPOLATED = "interpolated"
"""A column of corrections.csv that is ours alone: rows that follow the keys around them when these move."""


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    object: int = Field(ge=0, lt=MOST_OBJECTS)
    frame: int = Field(ge=0)


class BoxRow(_Row):
    """A template box, in clip pixels: left, top, width, height."""

    x: float
    y: float
    w: float
    h: float


class CorrectionRow(_Row):
    """Where an object is by the user's word, in clip pixels.

    Not visible with a position is occluded, the position being a guess that truth does not take over; without one it is
    lost.
    """

    x: float | None
    y: float | None
    visible: bool
    interpolated: bool


class ClipState(BaseModel):
    """All that was said about one clip."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    boxes: tuple[BoxRow, ...]
    corrections: tuple[CorrectionRow, ...]

    @property
    def revision(self) -> str:
        """A name of this state: two states have the same one only when they say the same."""
        ordered = ClipState(boxes=_sorted(self.boxes), corrections=_sorted(self.corrections))
        return hashlib.sha256(ordered.model_dump_json().encode()).hexdigest()[:32]

    def table(self, file: str, clip: str) -> pd.DataFrame:
        """The rows of `file` (TEMPLATES or CORRECTIONS) that say it, every cell as text."""
        rows = {TEMPLATES: self.boxes, CORRECTIONS: self.corrections}[file]
        columns = COLUMNS[file] if file == TEMPLATES else [*COLUMNS[file], INTERPOLATED]
        cells = [{"clip": clip} | {name: _text(value) for name, value in row.model_dump().items()} for row in rows]
        return pd.DataFrame(cells, columns=columns, dtype=object)


def of_clip(given: Annotations, clip: str) -> ClipState:
    """What `given` says about one clip."""
    boxes, corrections = (table[table["clip"] == clip] for table in (given.templates, given.corrections))
    followers = corrections[INTERPOLATED] == "true" if INTERPOLATED in corrections else [False] * len(corrections)
    return ClipState(
        boxes=tuple(BoxRow(**row) for row in boxes[COLUMNS[TEMPLATES][1:]].to_dict("records")),
        corrections=tuple(
            CorrectionRow(**row, interpolated=follows)
            for row, follows in zip(_with_none(corrections[COLUMNS[CORRECTIONS][1:]]), followers, strict=True)
        ),
    )


def _with_none(table: pd.DataFrame) -> list[dict[str, Any]]:
    return [
        {str(name): None if pd.isna(value) else value for name, value in row.items()}
        for row in table.to_dict("records")
    ]


def _sorted(rows: tuple) -> tuple:
    return tuple(sorted(rows, key=lambda row: (row.object, row.frame)))


def _text(value: float | bool | None) -> str:
    """A cell; six significant digits, as in every CSV of the project."""
    if value is None:
        return ""
    return str(value).lower() if isinstance(value, bool) else f"{value:.6g}"
