"""Film and tracks as the arrays that windows are cut from."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.utils.rnn import pad_sequence

from physpipe.core.determinism import device


def as_input(frames: NDArray[np.uint8]) -> Tensor:
    """(B, T, H, W, 3) uint8 to (B, T, 3, H, W) in [0, 1] on the device."""
    return torch.from_numpy(frames).to(device()).permute(0, 1, 4, 2, 3).float() / 255


def whole(xy: NDArray[np.float32], length: int) -> NDArray[np.bool_]:
    """For each start, whether `length` frames of xy (T, K, 2) from there on are all known."""
    known = np.isfinite(xy.sum(axis=(1, 2)))
    if len(known) < length:
        return np.zeros(0, bool)
    return np.logical_and.reduce(np.lib.stride_tricks.sliding_window_view(known, length), axis=1)


def padded(paths: Sequence[NDArray[np.float32]]) -> Tensor:
    """(B, L, K, 2) of paths (T, K, 2), those shorter than the longest going on as NaN."""
    return pad_sequence([torch.from_numpy(np.ascontiguousarray(each)) for each in paths], True, torch.nan)
