"""A clip's frames as few pictures that hold many each: the page shows any of them at once, exactly, in any browser."""

from math import ceil, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physpipe.report.embedding import webp

BLOCK_PX = 16
"""Of the codec: cells of whole blocks take no colour from their neighbours."""
PICTURE_PX = 4_000_000
"""Pixels of a picture, at most (but one frame at least): phones refuse to decode much larger ones."""
Frames = NDArray[np.uint8]


def strip(frames: Frames, quality: int) -> dict[str, Any]:
    """`frames` (T, H, W, 3) RGB as `pictures` of `each` frames, row by row in cells of `cell`, (width, height) px."""
    T, H, W = frames.shape[:3]
    height, width = (ceil(side / BLOCK_PX) * BLOCK_PX for side in (H, W))
    each = min(T, max(1, PICTURE_PX // (height * width)))
    columns = ceil(sqrt(each))
    parts = [frames[first : first + each] for first in range(0, T, each)]
    pictures = [webp(_tiled(_padded(part, height, width), columns), quality) for part in parts]
    return {"cell": [width, height], "columns": columns, "each": each, "pictures": pictures}


def _padded(frames: Frames, height: int, width: int) -> Frames:
    H, W = frames.shape[1:3]
    return np.pad(frames, ((0, 0), (0, height - H), (0, width - W), (0, 0)), mode="edge")


def _tiled(frames: Frames, columns: int) -> Frames:
    T, height, width = frames.shape[:3]
    rows = ceil(T / columns)
    cells = np.zeros((rows * columns, height, width, 3), np.uint8)
    cells[:T] = frames
    return cells.reshape(rows, columns, height, width, 3).swapaxes(1, 2).reshape(rows * height, columns * width, 3)
