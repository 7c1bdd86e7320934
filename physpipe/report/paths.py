"""True and forecast paths drawn onto one picture: all of a forecast at a glance."""

from collections.abc import Sequence

import numpy as np

from physpipe.report import colours
from physpipe.report.brushes import Array, Picture, dashes, dot, ellipse_90, enlarged, lines, ring, scaled, segments
from physpipe.report.overlays import Marks

SPOT_PX = 8.0
"""Radius of the rings on the true path, in px of the picture."""


def background(frames: Picture, count: int) -> Picture:
    """(H, W, 3) median of `count` of the clip's `frames` (T, H, W, 3), spread over it: what does not move."""
    chosen = np.linspace(0, len(frames) - 1, min(count, len(frames))).round().astype(int)
    return np.median(frames[chosen], axis=0).astype(np.uint8)


def draw_paths(ground: Picture, marks: Marks, last: int, spots: Sequence[int], upscale: int) -> Picture:
    """`ground` (H, W, 3) `upscale` times larger, with the paths from the last seen frame up to frame number `last`.

    Truth is a white line, each object a coloured dot where it was last seen, its forecast dashes from there. At the
    frames `spots` the truth has a ring, the forecast a dot and, where it has a covariance, its 90 % ellipse. Without
    a forecast the true path is the whole clip's up to `last`.
    """
    picture = enlarged(ground, upscale)
    seen = marks.ahead[0] - 1 if marks.ahead else 0
    truth = scaled(marks.truth, upscale)
    for path in truth[max(seen, 0) : last + 1].swapaxes(0, 1):
        lines(picture, segments(path), "#000000", width=4)
        lines(picture, segments(path), colours.TRUTH, width=2)
    for t in spots:
        for spot in truth[t] if seen < t < len(truth) else ():
            ring(picture, spot, SPOT_PX, colours.TRUTH)
    if marks.ahead:
        _draw_forecasts(picture, marks, last, [t for t in spots if t in marks.ahead], upscale)
    return picture


def _draw_forecasts(picture: Picture, marks: Marks, last: int, spots: Sequence[int], upscale: int) -> None:
    for k in range(marks.forecast.shape[1]):
        way: Array = scaled(marks.way(k, last), upscale)
        lines(picture, dashes(way), colours.FORECAST, width=2)
        for t in spots:
            ellipse_90(picture, marks.forecast[t, k], marks.covariance[t, k], upscale, colours.FORECAST)
            dot(picture, scaled(marks.forecast[t, k], upscale), colours.FORECAST)
        dot(picture, way[0], colours.of_object(k))
