"""Blobs of a map of strengths: connected pixels above a threshold, heaviest first."""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray


class Found(NamedTuple):
    """What was found in one frame, N things, heaviest first."""

    xy: NDArray[np.float64]
    """(N, 2) pixels, centres of mass."""
    share: NDArray[np.float64]
    """(N,) part of all the mass in the frame, in [0, 1]."""


NOTHING = Found(np.empty((0, 2)), np.empty(0))


def blobs(strength: NDArray[np.floating], threshold: float, least_px2: int) -> Found:
    """The blobs of `strength` (H, W) >= 0 above `threshold` that cover at least `least_px2` pixels."""
    labels = cv2.connectedComponents((strength > threshold).astype(np.uint8))[1]
    rows, columns = np.nonzero(labels)
    if not len(rows):
        return NOTHING
    which, weight = labels[rows, columns] - 1, strength[rows, columns].astype(np.float64)
    mass = np.bincount(which, weight)
    xy = np.stack([np.bincount(which, weight * place) / mass for place in (columns, rows)], axis=1)
    large = np.bincount(which) >= least_px2
    best = np.argsort(-np.where(large, mass, 0), kind="stable")[: large.sum()]
    return Found(xy[best], mass[best] / mass.sum())


def kept(strength: NDArray, hidden: NDArray[np.bool_] | None) -> NDArray:
    """`strength` (H, W) with 0 wherever it is to be ignored."""
    return strength if hidden is None else np.where(hidden, strength.dtype.type(0), strength)
