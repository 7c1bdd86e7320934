"""Frames with truth, track and forecast drawn onto them."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import pandas as pd

from physpipe.io import tracks
from physpipe.report import colours
from physpipe.report.brushes import (
    RING_PX,
    Array,
    Picture,
    dashes,
    dot,
    ellipse_90,
    enlarged,
    lines,
    ring,
    scaled,
    segments,
)


@dataclass(frozen=True)
class Marks:
    """What is drawn on one clip; clip pixels, NaN where there is nothing to draw."""

    truth: Array
    """(T, M, 2)"""
    track: Array
    """(T, K, 2)"""
    forecast: Array
    """(T, K, 2)"""
    covariance: Array
    """(T, K, 2, 2) px^2 of the forecast"""

    @property
    def ahead(self) -> list[int]:
        """Numbers of the frames that are forecast, none without a forecast."""
        return np.flatnonzero(np.isfinite(self.forecast[..., 0]).any(axis=1)).tolist()

    def way(self, k: int, t: int) -> Array:
        """(N, 2) clip pixels: where object `k` was last seen, then its forecast up to frame `t`."""
        seen = self.ahead[0] - 1
        return np.concatenate([self.track[seen : seen + 1, k], self.forecast[seen + 1 : t + 1, k]])


class Tables(Protocol):
    """Where marks come from; `Evidence` is one."""

    @property
    def truth(self) -> pd.DataFrame:
        """Track table; no rows where nobody annotated the film."""

    @property
    def track(self) -> pd.DataFrame:
        """Track table."""

    @property
    def forecast(self) -> pd.DataFrame:
        """Forecast table."""


def marks_of(evidence: Tables, clip: str) -> Marks:
    """The marks of one clip."""
    track = tracks.positions(evidence.track, clip)
    T = len(track)
    annotated = (evidence.truth["clip"] == clip).any()
    truth = tracks.positions(evidence.truth, clip) if annotated else np.full((T, 0, 2), np.nan)
    mine = evidence.forecast[evidence.forecast["clip"] == clip]
    forecast, covariance = np.full(track.shape, np.nan), np.full((*track.shape, 2), np.nan)
    at = mine["frame"].to_numpy(), mine["object"].to_numpy()
    forecast[at] = mine[["x", "y"]]
    if "cov_xx" in mine:
        covariance[at] = mine[["cov_xx", "cov_xy", "cov_xy", "cov_yy"]].to_numpy(float).reshape(-1, 2, 2)
    return Marks(truth, track, forecast, covariance)


def draw(frame: Picture, marks: Marks, t: int, upscale: int, trail: int) -> Picture:
    """`frame` (H, W, 3), number `t` of its clip, `upscale` times larger with its marks.

    Truth is a white ring, a track a coloured dot with its last `trail` frames, a forecast a dashed line
    from the last frame that the predictor saw, with its 90 % ellipse where it has one.
    """
    picture = enlarged(frame, upscale)
    for k in range(marks.track.shape[1]):
        trace = scaled(marks.track[max(0, t - trail) : t + 1, k], upscale)
        lines(picture, segments(trace), colours.of_object(k), width=2)
    if marks.ahead and t >= marks.ahead[0]:
        _draw_forecast(picture, marks, t, upscale)
    for spot in scaled(marks.truth[t], upscale):
        ring(picture, spot, RING_PX, colours.TRUTH)
    for k, spot in enumerate(scaled(marks.track[t], upscale)):
        dot(picture, spot, colours.of_object(k))
    return picture


def _draw_forecast(picture: Picture, marks: Marks, t: int, upscale: int) -> None:
    for k in range(marks.forecast.shape[1]):
        lines(picture, dashes(scaled(marks.way(k, t), upscale)), colours.FORECAST, width=2)
        dot(picture, scaled(marks.forecast[t, k], upscale), colours.FORECAST)
        ellipse_90(picture, marks.forecast[t, k], marks.covariance[t, k], upscale, colours.FORECAST)
