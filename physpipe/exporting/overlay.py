"""Films with tracks, truth and forecasts drawn in, a file a clip, at the clip's own times."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.exporting.encoding import encode
from physpipe.exporting.view import View
from physpipe.io.clips import ClipSet
from physpipe.report import colours
from physpipe.report.overlays import Marks, draw, marks_of

LETTER_PX = 22.0
"""Height of the font at scale 1."""
TEXT_PART = 1 / 30
"""Height of letters over the picture's."""
SMALLEST_TEXT_PX = 10.0
RIM = (-1, 0, 1)
FONT = cv2.FONT_HERSHEY_SIMPLEX
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Tables:
    """What is drawn."""

    truth: pd.DataFrame
    """Track table; no rows for none."""
    track: pd.DataFrame
    forecast: pd.DataFrame
    """Forecast table; no rows for none."""


def write_overlay(path: Path, clips: ClipSet, clip: str, tables: Tables, view: View, trail: int, slower: float) -> None:
    """Writes a film of one clip, `slower` times as slow as it was filmed, in the format that the suffix names.

    Objects carry their number; `trail` is the number of past positions drawn behind them.
    """
    times_s = clips.times_s(clip)
    fps = 1 / (float(np.median(np.diff(times_s))) * slower)
    marks = view.placed(marks_of(tables, clip))
    encode(path, _film(view, marks, clip, times_s, trail, slower), fps)


def _film(
    view: View, marks: Marks, clip: str, times_s: NDArray[np.float64], trail: int, slower: float
) -> Iterator[tuple[float, Picture]]:
    for t, (time_s, plain) in enumerate(zip(times_s.tolist(), view.pictures, strict=True)):
        picture = draw(plain, marks, t, 1, trail)
        size_px = max(SMALLEST_TEXT_PX, TEXT_PART * picture.shape[0])
        for number, (x, y) in enumerate(marks.track[t].tolist()):
            if np.isfinite(x):
                _write(picture, str(number), (x + size_px / 2, y - size_px / 2), size_px, colours.of_object(number))
        _write(picture, f"{clip}  frame {t}  {time_s:.2f} s", (4, picture.shape[0] - 6), size_px, colours.TRUTH)
        yield time_s * slower, picture


def _write(picture: Picture, text: str, at: tuple[float, float], size_px: float, colour: str) -> None:
    """Text with a dark rim, its left bottom corner at (x, y)."""
    # A thicker black text below would do for a rim, but OpenCV 5 sets thicker letters wider apart.
    for ink, dx, dy in (*(("#000000", dx, dy) for dx in RIM for dy in RIM), (colour, 0, 0)):
        spot = (round(at[0]) + dx, round(at[1]) + dy)
        cv2.putText(picture, text, spot, FONT, size_px / LETTER_PX, colours.rgb(ink), 1, cv2.LINE_AA)
