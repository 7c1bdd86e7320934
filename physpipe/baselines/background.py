"""What differs from a still background: blobs of change, told nothing."""

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.baselines.blobs import Found, blobs, kept
from physpipe.core.params import Section

Model = Literal["knn", "mog2"]


class ChangeParams(Section):
    """What counts as changed against the clip's temporal median."""

    threshold_grey: float = Field(gt=0, le=255)
    """Grey levels by which the most changed channel must differ."""
    blur_px: float = Field(gt=0)
    """Standard deviation of the Gaussian that smooths the change first."""


class BackgroundParams(Section):
    """What is foreground."""

    least_px2: int = Field(ge=1)
    """Pixels that a blob must cover."""
    median: ChangeParams
    knn_threshold: float = Field(gt=0)
    """Squared distance (grey levels) from a pixel's samples beyond which it is foreground."""
    mog2_threshold: float = Field(gt=0)
    """The same for Gaussian mixtures, over their variance."""
    history_frames: int = Field(ge=1)
    """Frames that both models remember."""
    mask_median_px: int = Field(ge=3)
    """Side of the median filter that cleans their masks; odd."""


def median_blobs(frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None, params: BackgroundParams) -> list[Found]:
    """Blobs of difference from the clip's temporal median, each frame's overall change of light taken off first."""
    background = np.median(frames, axis=0).astype(np.float32)
    found = []
    for t, frame in enumerate(frames):
        difference = frame - background
        difference -= np.median(difference, axis=(0, 1))
        strength = cv2.GaussianBlur(np.abs(difference).max(axis=2), (0, 0), params.median.blur_px)
        shown = kept(strength, None if ignore is None else ignore[t])
        found.append(blobs(shown, params.median.threshold_grey, params.least_px2))
    return found


def subtracted_blobs(
    frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None, params: BackgroundParams, model: Model
) -> list[Found]:
    """Blobs of the foreground of an OpenCV subtractor that has seen the whole clip once before; shadows left out."""
    cv2.setRNGSeed(0)  # both replace samples at random
    subtractor: cv2.BackgroundSubtractor
    if model == "knn":
        subtractor = cv2.createBackgroundSubtractorKNN(params.history_frames, params.knn_threshold, True)
    else:
        subtractor = cv2.createBackgroundSubtractorMOG2(params.history_frames, params.mog2_threshold, True)
    for frame in frames:
        subtractor.apply(frame)
    found = []
    for t, frame in enumerate(frames):
        foreground = (subtractor.apply(frame) == 255).astype(np.uint8)  # 127 marks a shadow
        mask = cv2.medianBlur(foreground, params.mask_median_px)
        found.append(blobs(kept(mask, None if ignore is None else ignore[t]), 0, params.least_px2))
    return found
