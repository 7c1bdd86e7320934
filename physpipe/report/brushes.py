"""Lines, dots and ellipses on enlarged frames, placed to a fraction of a pixel."""

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.report import colours

SUBPIXEL_BITS = 4
DASH_PX, RING_PX, DOT_PX = 7.0, 13.0, 5.0
CHI2_90 = 4.605
"""90 % of a two-dimensional Gaussian lies within this squared Mahalanobis distance."""
Array = NDArray[np.floating]
Picture = NDArray[np.uint8]


def enlarged(frame: Picture, upscale: int) -> Picture:
    """`frame` (H, W, 3), `upscale` times as high and wide."""
    size = (frame.shape[1] * upscale, frame.shape[0] * upscale)
    return np.asarray(cv2.resize(frame, size, interpolation=cv2.INTER_CUBIC), np.uint8)


def scaled(xy: Array, upscale: int) -> Array:
    """Clip pixels to pixels of the larger picture; both count from the centre of the top-left pixel."""
    return (xy + 0.5) * upscale - 0.5


def segments(path: Array) -> Array:
    """(N, 2, 2) pieces between neighbouring points of `path` (N + 1, 2)."""
    return np.stack([path[:-1], path[1:]], axis=1)


def dashes(path: Array) -> Array:
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


def lines(picture: Picture, pieces: Array, colour: str, width: int) -> None:
    """Draws `pieces` (N, 2, 2), px of the picture, those that are known."""
    whole = pieces[np.isfinite(pieces).all(axis=(1, 2))]
    fixed = np.round(whole * 2**SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(picture, list(fixed), False, colours.rgb(colour), width, cv2.LINE_AA, SUBPIXEL_BITS)


def ellipse_90(picture: Picture, mean: Array, covariance: Array, upscale: int, colour: str) -> None:
    """Outlines what should hold 90 % of a Gaussian: `mean` (2,) clip px, `covariance` (2, 2) px^2; nothing if NaN."""
    if np.isfinite(covariance).all():
        angle = np.linspace(0, 2 * np.pi, 49)
        unit = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.sqrt(CHI2_90)
        outline = mean + unit @ np.linalg.cholesky(covariance).T
        lines(picture, segments(scaled(outline, upscale)), colour, width=1)


def ring(picture: Picture, centre: Array, radius: float, colour: str) -> None:
    """An open circle with a black edge; `centre` (2,) and `radius` in px of the picture."""
    circle(picture, centre, radius, "#000000", width=4)
    circle(picture, centre, radius, colour, width=2)


def dot(picture: Picture, centre: Array, colour: str) -> None:
    """A disc with a black edge; `centre` (2,) px of the picture."""
    circle(picture, centre, DOT_PX + 1.5, "#000000", width=-1)
    circle(picture, centre, DOT_PX, colour, width=-1)


def circle(picture: Picture, centre: Array, radius: float, colour: str, width: int) -> None:
    """All in px of the picture, a negative `width` fills; nothing where `centre` (2,) is NaN."""
    if np.isfinite(centre).all():
        x, y, r = (round(float(each) * 2**SUBPIXEL_BITS) for each in (*centre, radius))
        cv2.circle(picture, (x, y), r, colours.rgb(colour), width, cv2.LINE_AA, SUBPIXEL_BITS)
