"""Frames with truth, track and forecast drawn onto them."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io import tracks
from physpipe.report import colours

SUBPIXEL_BITS = 4
DASH_PX, RING_PX, DOT_PX = 7.0, 13.0, 5.0
CHI2_90 = 4.605
"""90 % of a two-dimensional Gaussian lies within this squared Mahalanobis distance."""
Array = NDArray[np.floating]
Picture = NDArray[np.uint8]


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
    size = (frame.shape[1] * upscale, frame.shape[0] * upscale)
    picture: Picture = np.asarray(cv2.resize(frame, size, interpolation=cv2.INTER_CUBIC), np.uint8)
    for k in range(marks.track.shape[1]):
        trace = _scaled(marks.track[max(0, t - trail) : t + 1, k], upscale)
        _lines(picture, _segments(trace), colours.of_object(k), width=2)
    if marks.ahead and t >= marks.ahead[0]:
        _draw_forecast(picture, marks, t, upscale)
    for spot in _scaled(marks.truth[t], upscale):
        _circle(picture, spot, RING_PX, "#000000", width=4)
        _circle(picture, spot, RING_PX, colours.TRUTH, width=2)
    for k, spot in enumerate(_scaled(marks.track[t], upscale)):
        _dot(picture, spot, colours.of_object(k))
    return picture


def _draw_forecast(picture: Picture, marks: Marks, t: int, upscale: int) -> None:
    seen = marks.ahead[0] - 1
    for k in range(marks.forecast.shape[1]):
        path = np.concatenate([marks.track[seen : seen + 1, k], marks.forecast[seen + 1 : t + 1, k]])
        _lines(picture, _dashes(_scaled(path, upscale)), colours.FORECAST, width=2)
        _dot(picture, _scaled(marks.forecast[t, k], upscale), colours.FORECAST)
        spread = marks.covariance[t, k]
        if np.isfinite(spread).all():
            angle = np.linspace(0, 2 * np.pi, 49)
            circle = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.sqrt(CHI2_90)
            ellipse = marks.forecast[t, k] + circle @ np.linalg.cholesky(spread).T
            _lines(picture, _segments(_scaled(ellipse, upscale)), colours.FORECAST, width=1)


def _scaled(xy: Array, upscale: int) -> Array:
    """Clip pixels to pixels of the larger picture; both count from the centre of the top-left pixel."""
    return (xy + 0.5) * upscale - 0.5


def _segments(path: Array) -> Array:
    """(N, 2, 2) pieces between neighbouring points of `path` (N + 1, 2)."""
    return np.stack([path[:-1], path[1:]], axis=1)


def _dashes(path: Array) -> Array:
    """(N, 2, 2) dashes of equal length along `path`."""
    path = path[np.isfinite(path).all(axis=1)]
    if len(path) < 2:
        return np.empty((0, 2, 2))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    starts = np.arange(0.0, along[-1] + 1e-9, 2 * DASH_PX)
    ends = np.minimum(starts + DASH_PX, along[-1])
    return np.stack([[np.interp(part, along, path[:, axis]) for axis in (0, 1)] for part in (starts, ends)]).T.swapaxes(
        1, 2
    )


def _lines(picture: Picture, pieces: Array, colour: str, width: int) -> None:
    whole = pieces[np.isfinite(pieces).all(axis=(1, 2))]
    fixed = np.round(whole * 2**SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(picture, list(fixed), False, colours.rgb(colour), width, cv2.LINE_AA, SUBPIXEL_BITS)


def _dot(picture: Picture, centre: Array, colour: str) -> None:
    _circle(picture, centre, DOT_PX + 1.5, "#000000", width=-1)
    _circle(picture, centre, DOT_PX, colour, width=-1)


def _circle(picture: Picture, centre: Array, radius: float, colour: str, width: int) -> None:
    if np.isfinite(centre).all():
        x, y, r = (round(float(each) * 2**SUBPIXEL_BITS) for each in (*centre, radius))
        cv2.circle(picture, (x, y), r, colours.rgb(colour), width, cv2.LINE_AA, SUBPIXEL_BITS)
