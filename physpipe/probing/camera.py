"""How the camera and the light behave: shake, flicker, focus."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

LONGEST_PX = 240
"""Longest side of the pictures by which shifts are measured."""
BETTER = 0.95
"""A shift must leave less than this part of the difference that there was."""
LEAST_GREY = 0.05
"""And by so many grey levels less."""
FAR_OUT = 8.0
"""Times the mean difference; what differs more is left out when that is judged."""
OUTLIER = 3.0
"""Times the usual difference; what differs more moves by itself."""
CAP_GREY = 20.0
"""Grey levels beyond which a difference counts no more."""
EDGES = 0.02
"""Share of the pixels, the steepest, that count as edges."""
LEAST_STEEP = 2.0
"""Grey levels a pixel; flatter slopes are no edges."""
SLOPE_BLUR_PX2 = 0.5
"""Square pixels, the blur that measuring a slope over three pixels adds."""
REBLUR_PX = 1.5
"""Blur that is added to see how much there was."""
Grey = NDArray[Any]
"""(h, w) float32 grey levels."""


def grey(picture: NDArray[np.uint8]) -> Grey:
    """(h, w, 3) RGB to grey levels."""
    return cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_RGB2GRAY).astype(np.float32)


def shift(one: Grey, two: Grey) -> NDArray[np.float64]:
    """(x, y) pixels by which most of the picture moved from `one` to `two`; zero where no shift explains it better."""
    factor = min(1.0, LONGEST_PX / max(one.shape))
    size = (round(one.shape[1] * factor), round(one.shape[0] * factor))
    small = [cv2.GaussianBlur(cv2.resize(each, size, interpolation=cv2.INTER_AREA), (0, 0), 1.0) for each in (one, two)]
    first, second = small[0], small[1] / gain(*small)
    jump, _ = cv2.phaseCorrelate(_evened(first), _evened(second), cv2.createHanningWindow(size, cv2.CV_32F))
    still, ground = np.zeros(2), _ground(first, second)
    guess = min((still, np.array(jump)), key=lambda moved: _left_over(first, second, moved, ground))
    fine = _refined(first, second, guess)
    before, after = (_left_over(first, second, moved, ground) for moved in (still, fine))
    return fine / factor if after < min(BETTER * before, before - LEAST_GREY) else still


def _ground(one: Grey, two: Grey) -> NDArray[np.bool_]:
    """What changes no more than usual: a ball alone before a wall is not taken for a moving camera."""
    apart = np.abs(two - one)
    outliers = (apart > max(FAR_OUT * float(apart.mean()), 1.0)).astype(np.uint8)
    return ~cv2.dilate(outliers, np.ones((9, 9), np.uint8)).astype(bool)


def _evened(image: Grey) -> Grey:
    """Without what stands out, a ball before all: the ground is what tells how the camera moved."""
    middle = np.median(image)
    most = max(OUTLIER * float(np.median(np.abs(image - middle))), 1.0)
    return np.clip(image - middle, -most, most)


def _refined(one: Grey, two: Grey, guess: NDArray[np.float64]) -> NDArray[np.float64]:
    """By maximum correlation of what does not move by itself."""
    usual = np.abs(moved_back(two, guess) - one)
    mask = (usual <= max(OUTLIER * float(usual.mean()), 1.0)).astype(np.uint8)
    start = np.array([[1, 0, guess[0]], [0, 1, guess[1]]], np.float32)
    stop = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 15, 1e-3)
    try:
        return cv2.findTransformECC(one, two, start, cv2.MOTION_TRANSLATION, stop, mask, 5)[1][:, 2].astype(float)
    except cv2.error:  # nothing to hold on to
        return guess


def _left_over(one: Grey, two: Grey, moved: NDArray[np.float64], ground: NDArray[np.bool_]) -> float:
    """Mean difference in grey levels that a shift leaves on the `ground`, which is not empty; large ones are capped."""
    return float(np.minimum(np.abs(moved_back(two, moved) - one), CAP_GREY)[ground].mean())


def gain(one: Grey, two: Grey) -> float:
    """Brightness of `two` over that of `one`, by what is neither black nor blown out."""
    fair = (one > 24) & (one < 232) & (two < 232)
    return float(np.median(two[fair] / one[fair])) if fair.any() else 1.0


def moved_back(picture: NDArray[Any], by: NDArray[np.float64]) -> NDArray[Any]:
    """`picture` with its content moved by minus `by` (x, y) pixels."""
    to = np.array([[1.0, 0, -by[0]], [0, 1.0, -by[1]]])
    return cv2.warpAffine(picture, to, picture.shape[1::-1], borderMode=cv2.BORDER_REPLICATE)


def blur_px(image: Grey) -> float:
    """Standard deviation of the blur of the steepest edges, in pixels; NaN without edges.

    An edge of blur s, blurred by r once more, is less steep by the factor s / sqrt(s^2 + r^2) (Zhuo and Sim 2011).
    """
    steep = steepness(image)
    again = steepness(cv2.GaussianBlur(image, (0, 0), REBLUR_PX))
    edges = (steep >= np.quantile(steep, 1 - EDGES)) & (steep > LEAST_STEEP)
    if not edges.any():
        return float("nan")
    ratio = float(np.median(steep[edges] / np.maximum(again[edges], 1e-6)))
    return float(np.sqrt(max(REBLUR_PX**2 / max(ratio**2 - 1, 1e-6) - SLOPE_BLUR_PX2, 0)))


def steepness(image: Grey) -> Grey:
    return np.hypot(*(cv2.Sobel(image, cv2.CV_32F, x, y, scale=1 / 8) for x, y in ((1, 0), (0, 1))))
