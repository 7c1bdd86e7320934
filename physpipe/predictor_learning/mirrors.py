"""Film and positions of the same scene, mirrored and turned."""

import numpy as np
from numpy.typing import NDArray

Symmetry = tuple[bool, bool, bool]
"""Mirrored in x, mirrored in y, x and y swapped: the eight together are all turns and mirrors of a square."""


def mirrored(
    frames: NDArray[np.uint8], xy: NDArray[np.float32], how: Symmetry
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Frames (T, H, W, 3) and positions (N, K, 2) px of the same scene, mirrored in x, in y, then x and y swapped."""
    flip_x, flip_y, swap = how
    height, width = frames.shape[1:3]
    if flip_x:
        frames, xy = frames[:, :, ::-1], np.stack([width - 1 - xy[..., 0], xy[..., 1]], axis=-1)
    if flip_y:
        frames, xy = frames[:, ::-1], np.stack([xy[..., 0], height - 1 - xy[..., 1]], axis=-1)
    if swap:
        frames, xy = frames.swapaxes(1, 2), xy[..., ::-1]
    return frames, xy
