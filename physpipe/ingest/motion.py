"""Where a recording starts and stops moving, despite sensor noise, drifting light and a wobbling camera."""

from collections import deque
from itertools import chain, repeat
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section

NOISE_FLOOR = 0.5  # grey levels: what rounding to uint8 alone does to a difference
BLUR_PX = 1.0  # makes shifts of a pixel or two linear in the slopes, and noise smaller
COARSE_STEPS = 3
OUTLIER = 3.0  # times the mean absolute difference
NOISIEST = 5.0  # times the usual block's; what lies above is motion that never pauses
QUIET = 0.25  # quantile over time that still is noise when something moves through a block most of the time

Grey = NDArray[Any]
"""(H, W) float32 grey levels."""


class _Alignment(NamedTuple):
    """What turns one picture into another but for what moves: shift (x, y) in pixels, gain, offset in grey levels."""

    shift: NDArray[np.float64]
    gain: float
    offset: float


class TrimParams(Section):
    """What counts as motion."""

    lag: int = Field(ge=1)
    """Frames between the two that are compared; more finds slower motion."""
    block_px: int = Field(ge=2)
    """Side of the square blocks, in clip pixels: about the size of the smallest object."""
    wobble_px: float = Field(ge=0)
    """Shift in clip pixels that alignment may leave; what such a shift changes is no motion."""
    threshold: float = Field(gt=1)
    """A block moves when its squared difference is this many times its own noise level."""
    min_moving: int = Field(ge=1)
    """Fewer moving frames in a row are a flicker or a codec's key frame, not motion."""
    margin: int = Field(ge=0)
    """Frames kept on either side of what moves visibly: about two hold motion too small to be seen; 0 leaves no frame
    before a sudden release."""


def moving_span(frames: NDArray[np.uint8], params: TrimParams) -> tuple[int, int] | None:
    """First and last frame of (T, H, W, 3) `frames` that move, margins included, or None when nothing does."""
    moving = motion(frames, params) > params.threshold
    runs = np.convolve(moving, np.ones(params.min_moving), "valid") == params.min_moving
    found = np.flatnonzero(runs)
    if not len(found):
        return None
    first_moved = int(found[0]) + 1
    last_to_move = int(found[-1]) + params.min_moving - params.lag
    return max(first_moved - params.margin, 0), min(last_to_move + params.margin, len(frames) - 1)


def motion(frames: NDArray[np.uint8], params: TrimParams) -> NDArray[np.floating]:
    """(T + lag - 2,) squared difference of the liveliest block over its noise level, of frames i + 1 - lag and i + 1.

    Before the first and after the last frame all stands still.
    """
    still = params.lag - 1
    earlier: deque[Grey] = deque(maxlen=params.lag)
    energies = []
    for frame in chain(repeat(frames[0], still), frames, repeat(frames[-1], still)):
        grey = _grey(frame)
        if len(earlier) == params.lag:
            energies.append(_block_energy(earlier[0], grey, params))
        earlier.append(grey)
    energy = np.stack(energies)
    noise = np.quantile(energy, QUIET, axis=0)
    usual = max(np.median(noise), 1.0)
    return (energy / np.clip(noise, usual, NOISIEST * usual)).max(axis=1)


def _grey(frame: NDArray[np.uint8]) -> Grey:
    grey = cv2.cvtColor(np.ascontiguousarray(frame), cv2.COLOR_RGB2GRAY)
    return cv2.GaussianBlur(grey.astype(np.float32), (0, 0), BLUR_PX)


def _block_energy(one: Grey, two: Grey, params: TrimParams) -> Grey:
    """Mean squared difference of each block after alignment, in units of rounding and of leftover wobble."""
    shift, gain, offset = _alignment(one, two)
    aligned = gain * _shifted(one, shift) + offset
    slope = _slope(two, 1, 0) ** 2 + _slope(two, 0, 1) ** 2
    energy = (two - aligned) ** 2 / (NOISE_FLOOR**2 + params.wobble_px**2 * slope)
    edge_x, edge_y = np.ceil(np.abs(shift)).astype(int) + 1  # what the shift brought in from outside is unknown
    energy[:edge_y] = energy[-edge_y:] = energy[:, :edge_x] = energy[:, -edge_x:] = 0
    height, width = (max(side // params.block_px, 1) for side in two.shape)
    return cv2.resize(energy, (width, height), interpolation=cv2.INTER_AREA).ravel()


def _alignment(one: Grey, two: Grey) -> _Alignment:
    """Shift (x, y) in pixels, gain and offset that make `one` most like `two`: at half resolution, then in full."""
    coarse = _Alignment(np.zeros(2), 1.0, 0.0)
    halves = _halved(one), _halved(two)
    for _ in range(COARSE_STEPS):
        coarse = _improved(coarse, *halves)
    return _improved(_Alignment(2 * coarse.shift, coarse.gain, coarse.offset), one, two)


def _improved(found: _Alignment, one: Grey, two: Grey) -> _Alignment:
    """One Gauss-Newton step; pixels that differ more than usual, such as a ball's, have no say."""
    moved, wanted = _shifted(one, found.shift), two.ravel()
    basis = np.stack([_slope(moved, 1, 0), _slope(moved, 0, 1), moved, np.ones_like(moved)]).reshape(4, -1)
    difference = np.abs(wanted - found.gain * basis[2] - found.offset)
    usual = basis * (difference <= OUTLIER * difference.mean())
    *step, gain, offset = np.linalg.lstsq((usual @ basis.T).astype(float), usual @ wanted, rcond=1e-6)[0].tolist()
    return _Alignment(found.shift - np.clip(np.array(step) / max(gain, 0.1), -1, 1), gain, offset)


def _halved(image: Grey) -> Grey:
    return cv2.resize(image, (image.shape[1] // 2, image.shape[0] // 2), interpolation=cv2.INTER_AREA)


def _slope(image: Grey, x: int, y: int) -> Grey:
    return cv2.Sobel(image, cv2.CV_32F, x, y, scale=1 / 8)


def _shifted(image: Grey, shift: NDArray[np.float64]) -> Grey:
    """Content moved by `shift` (x, y) pixels."""
    to = np.array([[1, 0, shift[0]], [0, 1, shift[1]]])
    return cv2.warpAffine(image, to, image.shape[::-1], borderMode=cv2.BORDER_REPLICATE)
