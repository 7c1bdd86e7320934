"""Frames as networks take them."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physpipe.core.determinism import device


def as_images(frames: NDArray[np.uint8]) -> Tensor:
    """(..., H, W, 3) uint8 to (..., 3, H, W) float in [0, 1] on the computing device."""
    return torch.from_numpy(frames).to(device()).movedim(-1, -3).float() / 255
