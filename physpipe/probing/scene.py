"""A recording's pictures as a camera on a tripod in steady light would have taken them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.probing import camera
from physpipe.probing.sampling import Pair

LEAST_GREY = 12.0
"""Grey levels by which what moves differs from the background."""
NOISE = 6.0
"""Times the sensor's noise, likewise."""
SLOPE_PX = 0.5
"""Shift in pixels that aligning two pictures may leave, likewise."""
LEAST_AREA = 12
"""Pixels; a smaller change is noise."""
SMALLEST_SHIFT_PX, SMALLEST_GAIN = 0.1, 0.004
Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Scene:
    """P pairs of neighbouring frames; all in pixels of the reduced pictures."""

    first: list[Picture]
    second: list[Picture]
    background: Picture
    shifts: NDArray[np.float64]
    """(2, P, 2) pixels by which first and second frames had moved from the reference."""
    gains: NDArray[np.float64]
    """(2, P) their brightness over the reference's."""
    least: NDArray[Any]
    """(h, w) grey levels by which a pixel differs from the background where something else covers it."""
    moving: Mask
    """(P,) whether anything moved between this pair and the one before; the first is as the second."""

    def covered(self, picture: Picture) -> tuple[Mask, Picture]:
        """Where something hides the background, and by how many grey levels it differs."""
        apart = _difference(self.background, picture)
        return _large(apart > self.least), apart


def steadied(pairs: Sequence[Pair]) -> Scene:
    """Takes back shift and change of light since the middle pair, then tells what stands still."""
    P = len(pairs)
    reference = camera.grey(pairs[P // 2].first)
    shown = [each.first for each in pairs] + [each.second for each in pairs]
    looks = [_steadied(reference, picture) for picture in shown]
    pictures, moves, gains = (list(part) for part in zip(*looks, strict=True))
    first, second = pictures[:P], pictures[P:]
    shifts = np.reshape(moves, (2, P, 2))
    least = _least_difference(reference, _noise(first, second), shifts)
    between = [_changed(one, two, least) for one, two in pairwise(first)]
    moving = np.array([between[0], *between] if between else [_changed(first[0], second[0], least)])
    return Scene(first, second, _background(first, moving), shifts, np.reshape(gains, (2, P)), least, moving)


def _steadied(reference: camera.Grey, picture: Picture) -> tuple[Picture, NDArray[np.float64], float]:
    grey = camera.grey(picture)
    moved = camera.shift(reference, grey)
    if np.hypot(*moved) > SMALLEST_SHIFT_PX:
        picture, grey = camera.moved_back(picture, moved), camera.moved_back(grey, moved)
    gain = camera.gain(reference, grey)
    if abs(gain - 1) > SMALLEST_GAIN:
        picture = cv2.convertScaleAbs(picture, alpha=1 / gain).astype(np.uint8, copy=False)
    return picture, moved, gain


def _noise(first: list[Picture], second: list[Picture]) -> float:
    """Grey levels, the sensor's standard deviation, from what changes between neighbours."""
    apart = [np.abs(one[::3, ::3].astype(np.int16) - two[::3, ::3]) for one, two in zip(first, second, strict=True)]
    return 1.4826 * float(np.median(apart)) / np.sqrt(2)


def _least_difference(reference: camera.Grey, noise: float, shifts: NDArray[np.float64]) -> NDArray[Any]:
    least = max(LEAST_GREY, NOISE * noise) + SLOPE_PX * camera.steepness(reference)
    unknown = np.ceil(np.abs(shifts).max(axis=(0, 1))).astype(int)  # what a shift brought in is no change
    if unknown[0]:
        least[:, : unknown[0]] = least[:, -unknown[0] :] = np.inf
    if unknown[1]:
        least[: unknown[1]] = least[-unknown[1] :] = np.inf
    return least


def _background(pictures: list[Picture], moving: Mask) -> Picture:
    """What most frames show from the first to the last that moves, so that a long rest hides nothing."""
    span = np.flatnonzero(moving)
    chosen = pictures[span[0] : span[-1] + 1] if len(span) > 2 else pictures
    return np.median(chosen, axis=0).astype(np.uint8)


def _difference(one: Picture, two: Picture) -> Picture:
    """(h, w) grey levels by which the most different colour of two pictures differs."""
    smooth = [cv2.GaussianBlur(each, (0, 0), 1.0) for each in (one, two)]
    red, green, blue = cv2.split(cv2.absdiff(*smooth))
    return cv2.max(cv2.max(red, green), blue).astype(np.uint8, copy=False)


def _changed(one: Picture, two: Picture, least: NDArray[Any]) -> bool:
    return bool(_large(_difference(one, two) > least).any())


def _large(mask: Mask) -> Mask:
    """Without specks."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(closed)
    large = stats[:, cv2.CC_STAT_AREA] >= LEAST_AREA
    large[0] = False
    return large[labels]
