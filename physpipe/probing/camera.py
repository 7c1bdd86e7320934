"""How the camera and the light behave: shake, flicker, focus."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

LONGEST_PX = 240
"""Longest side of the pictures by which shifts are measured."""
BETTER = 0.95
"""A shift must leave less than this part of the difference that there was."""
OUTLIER = 3.0
"""Times the mean difference; what differs more moves by itself."""
CAP_GREY = 20.0
"""Grey levels beyond which a difference counts no more."""
EDGES = 0.02
"""Share of the pixels, the steepest, that count as edges."""
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
    light = small[1] / gain(*small)
    window = cv2.createHanningWindow(size, cv2.CV_32F)
    jump, _ = cv2.phaseCorrelate(small[0] - small[0].mean(), light - light.mean(), window)
    still = np.zeros(2)
    guess = min((still, np.array(jump)), key=lambda moved: _left_over(small[0], light, moved))
    fine = _refined(small[0], light, guess)
    better = _left_over(small[0], light, fine) < BETTER * _left_over(small[0], light, still)
    return fine / factor if better else still


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


def _left_over(one: Grey, two: Grey, moved: NDArray[np.float64]) -> float:
    """Mean difference in grey levels that a shift leaves; what moves by itself counts no more than CAP each pixel."""
    return float(np.minimum(np.abs(moved_back(two, moved) - one), CAP_GREY).mean())


def gain(one: Grey, two: Grey) -> float:
    """Brightness of `two` over that of `one`, by what is neither black nor blown out."""
    fair = (one > 24) & (one < 232) & (two < 232)
    return float(np.median(two[fair] / one[fair])) if fair.any() else 1.0


def moved_back(picture: NDArray[Any], by: NDArray[np.float64]) -> NDArray[Any]:
    """`picture` with its content moved by minus `by` (x, y) pixels."""
    to = np.array([[1.0, 0, -by[0]], [0, 1.0, -by[1]]])
    return cv2.warpAffine(picture, to, picture.shape[1::-1], borderMode=cv2.BORDER_REPLICATE)


def blur_px(image: Grey, where: NDArray[np.bool_] | None = None) -> float:
    """Standard deviation of the blur of the steepest edges, in pixels; NaN without edges.

    An edge of blur s, blurred by r once more, is less steep by the factor s / sqrt(s^2 + r^2) (Zhuo and Sim 2011).
    """
    steep = steepness(image)
    again = steepness(cv2.GaussianBlur(image, (0, 0), REBLUR_PX))
    inside = np.ones(image.shape, bool) if where is None else where
    if not inside.any():
        return float("nan")
    edges = inside & (steep >= np.quantile(steep[inside], 1 - EDGES)) & (steep > 2.0)
    if not edges.any():
        return float("nan")
    ratio = float(np.median(steep[edges] / np.maximum(again[edges], 1e-6)))
    return REBLUR_PX / np.sqrt(max(ratio**2 - 1, 1e-6))


def steepness(image: Grey) -> Grey:
    return np.hypot(*(cv2.Sobel(image, cv2.CV_32F, x, y, scale=1 / 8) for x, y in ((1, 0), (0, 1))))
