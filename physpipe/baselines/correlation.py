"""Zero-normalised cross-correlation (ZNCC) of a patch with a frame, and its peaks to a fraction of a pixel."""

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def zncc(frame: NDArray[np.float32], patch: NDArray[np.float32], flat_lab: float) -> NDArray[np.float32]:
    """(H, W) correlation in [-1, 1] of `patch` (h, w, 3) with its surroundings at every pixel of `frame` (H, W, 3).

    The pixel is the patch's middle one; the frame's edge is repeated outwards. Flat surroundings, or a flat patch,
    correlate with nothing: 0.
    """
    h, w = patch.shape[:2]
    if np.sqrt(patch.var(axis=(0, 1)).sum()) < flat_lab:
        return np.zeros(frame.shape[:2], np.float32)
    anchor = ((w - 1) // 2, (h - 1) // 2)
    centred = frame - frame.mean(axis=(0, 1))  # small numbers keep the digits of sums of squares
    padded = cv2.copyMakeBorder(centred, anchor[1], h // 2, anchor[0], w // 2, cv2.BORDER_REPLICATE)
    response = cv2.matchTemplate(padded, patch, cv2.TM_CCOEFF_NORMED)
    means, squares = (
        cv2.boxFilter(values, cv2.CV_64F, (w, h), anchor=anchor, borderType=cv2.BORDER_REPLICATE)
        for values in (centred, centred**2)
    )
    flat = (squares - means**2).sum(axis=2) < flat_lab**2
    return np.where(flat, 0, response).clip(-1, 1).astype(np.float32)


def peaks(response: NDArray[np.float32], count: int, ignore: NDArray[np.bool_] | None) -> tuple[Floats, Floats]:
    """The `count` highest local maxima, or fewer: (n, 2) sub-pixel positions and (n,) heights there.

    The height between pixels matters: else an object that stops on a whole pixel looks more alike than one that moves.
    """
    top = response >= cv2.dilate(response, np.ones((3, 3), np.uint8))
    if ignore is not None:
        top &= ~ignore
    rows, columns = np.nonzero(top)
    best = np.argsort(-response[rows, columns], kind="stable")[:count]
    rows, columns = rows[best], columns[best]
    padded = np.pad(response.astype(np.float64), 1, mode="edge")
    middle = padded[rows + 1, columns + 1]
    x, gain_x = _vertex(padded[rows + 1, columns], middle, padded[rows + 1, columns + 2])
    y, gain_y = _vertex(padded[rows, columns + 1], middle, padded[rows + 2, columns + 1])
    return np.stack([columns + x, rows + y], axis=1), middle + gain_x + gain_y


def _vertex(before: Floats, middle: Floats, after: Floats) -> tuple[Floats, Floats]:
    """Of the parabola through three neighbours: where it is highest, in px from the middle one and within half a
    pixel, and how much higher it is there."""
    bend = 2 * middle - before - after
    offset = np.where(bend > 0, (after - before) / (2 * np.where(bend > 0, bend, 1)), 0).clip(-0.5, 0.5)
    return offset, offset * (after - before) / 4
