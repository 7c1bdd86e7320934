"""How far trackers are from the truth: pure functions of arrays.

Throughout, positions are (T, K, 2) pixels, NaN where an object is not seen; a tracker's lost frames count wherever
the truth is visible.
"""

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.optimize import linear_sum_assignment

from physpipe.core.params import Section

Floats = NDArray[np.floating]
TAP_VID_PX = np.array([1, 2, 4, 8, 16])
"""Thresholds of TAP-Vid (Doersch et al. 2022), in pixels of a 256 x 256 frame."""


def distance(found: Floats, truth: Floats) -> Floats:
    """(...) error in pixels of (..., 2) positions, NaN where either side has none."""
    return np.linalg.norm(found - truth, axis=-1)


def match(found: Floats, truth: Floats) -> Floats:
    """`found` (T, K, 2) in the order of `truth` (T, M, 2): one to one over the whole clip, by least mean error.

    A lost frame counts as much as the clip's worst error. A true object that gets no track is lost throughout.
    """
    visible = np.isfinite(truth).all(axis=2, keepdims=True)  # (T, M, 1)
    errors = distance(found[:, None], truth[:, :, None])  # (T, M, K)
    worst = np.nanmax(errors, initial=0)
    cost = np.where(visible, np.where(np.isnan(errors), worst, errors), 0).sum(axis=0)
    ordered = np.full(truth.shape, np.nan)
    objects, tracks = linear_sum_assignment(cost)
    ordered[:, objects] = found[:, tracks]
    return ordered


def error_figures(offsets: Floats) -> dict[str, float]:
    """Figures of (N, 2) error vectors of found positions, NaN when N = 0.

    `mean_px`, `median_px`, `p99_px` and `var_px2` are of the error's length (the paper's mean and variance);
    `bias_px` is the length of the mean vector and `jitter_px` the spread about it, so that
    bias^2 + jitter^2 = mean squared error.
    """
    if not len(offsets):
        return dict.fromkeys(["mean_px", "median_px", "p99_px", "var_px2", "bias_px", "jitter_px"], np.nan)
    lengths, mean = np.linalg.norm(offsets, axis=1), offsets.mean(axis=0)
    figures = {
        "mean_px": lengths.mean(),
        "median_px": np.median(lengths),
        "p99_px": np.percentile(lengths, 99),
        "var_px2": lengths.var(),
        "bias_px": np.linalg.norm(mean),
        "jitter_px": np.sqrt(((offsets - mean) ** 2).sum(axis=1).mean()),
    }
    return {name: float(value) for name, value in figures.items()}


def delta_avg(found: Floats, truth: Floats, width: int, height: int) -> float:
    """TAP-Vid's share of visible points within 1, 2, 4, 8, 16 px, averaged, in a frame stretched to 256 x 256.

    Lost frames are never within. NaN when the truth is never visible.
    """
    visible = np.isfinite(truth).all(axis=-1)
    if not visible.any():
        return np.nan
    stretched = np.linalg.norm((found - truth)[visible] * (256 / np.array([width, height])), axis=-1)
    return float((stretched[:, None] < TAP_VID_PX).mean())


def longest_run(marks: NDArray[np.bool_]) -> int:
    """Length of the longest stretch of True in (T,)."""
    edges = np.flatnonzero(np.diff(marks.astype(np.int8), prepend=0, append=0))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def off_track(found: Floats, truth: Floats, limit_px: float, frames: int) -> bool:
    """Whether a (T, 2) track was more than `limit_px` off, or lost, for `frames` visible frames in a row."""
    visible = np.isfinite(truth).all(axis=1)
    return longest_run(~(distance(found, truth)[visible] <= limit_px)) >= frames


def swapped(found: Floats, truth: Floats, diameter_px: float, frames: int) -> bool:
    """Whether matched tracks (T, K, 2) exchanged objects for `frames` frames in a row.

    Judged where everything is seen and all objects are more than a diameter apart: nearer than that, nobody can say
    which is which.
    """
    K = truth.shape[1]
    apart = distance(truth[:, :, None], truth[:, None]) + np.where(np.eye(K), np.inf, 0)
    clear = np.isfinite(found).all(axis=(1, 2)) & (apart > diameter_px).all(axis=(1, 2))
    costs = distance(found[clear, None], truth[clear][:, :, None])  # (T', objects, tracks)
    exchanged = [(linear_sum_assignment(cost)[1] != np.arange(K)).any() for cost in costs]
    return longest_run(np.array(exchanged, bool)) >= frames


def bootstrap_interval(sums: Floats, counts: Floats, resamples: int) -> tuple[float, float]:
    """95 % interval of sum(sums) / sum(counts) when whole clips are drawn anew; (n,) per clip.

    Frames of one clip resemble each other, so the clip, not the frame, is what is drawn.
    """
    if not counts.sum():
        return np.nan, np.nan
    # The same draws for every method, so that their intervals compare.
    drawn = np.random.default_rng(0).integers(len(sums), size=(resamples, len(sums)))
    with np.errstate(invalid="ignore"):  # a draw of clips without any found frame has no mean
        low, high = np.nanpercentile(sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1), [2.5, 97.5])
    return float(low), float(high)


class OtherMotionParams(Section):
    """When something besides the objects moves, such as a hand."""

    threshold_grey: float = Field(gt=0, le=255)
    """Grey levels (0 to 255) by which a pixel must differ from its clip's temporal median."""
    narrowest_px: int = Field(ge=1)
    """Width of the narrowest mover; what differs on a narrower strip is an edge that the camera's wobble moved."""
    share: float = Field(gt=0, lt=1)
    """Share of the frame's pixels that must belong to such movers."""
    disc_radii: float = Field(ge=1)
    """Radius of the disc that is left out around each object, in its radii: room for blur and shadow."""


def other_motion(
    frames: NDArray[np.uint8], truth: Floats, radius_px: float, params: OtherMotionParams
) -> NDArray[np.bool_]:
    """(T,) whether something besides the objects at `truth` (T, K, 2) moves in `frames` (T, H, W, 3).

    Seen against the median of each pixel over the frames in which no object covers it, so that an object that rests
    leaves no ghost. A change of the whole frame's brightness does not count.
    """
    H, W = frames.shape[1:3]
    x, y = np.moveaxis(truth.astype(np.float32)[:, :, None, None], -1, 0)
    squared_px = (np.arange(W, dtype=np.float32) - x) ** 2 + (np.arange(H, dtype=np.float32)[:, None] - y) ** 2
    objects = (squared_px <= (params.disc_radii * radius_px) ** 2).any(axis=1)
    grey = frames.mean(axis=3, dtype=np.float32)
    in_order = np.sort(np.where(objects, np.inf, grey), axis=0)
    middle = np.maximum((~objects).sum(axis=0) - 1, 0) // 2
    change = np.where(objects, np.nan, grey) - np.take_along_axis(in_order, middle[None], axis=0)
    change -= np.nanmedian(change.reshape(len(change), -1), axis=1)[:, None, None]
    moved = (np.abs(change) > params.threshold_grey).astype(np.uint8)  # NaN, an object, is not above
    square = np.ones((params.narrowest_px, params.narrowest_px), np.uint8)
    moved = np.stack([cv2.morphologyEx(each, cv2.MORPH_OPEN, square) for each in moved])
    return moved.mean(axis=(1, 2)) > params.share
