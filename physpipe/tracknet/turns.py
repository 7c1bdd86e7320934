"""Mirrors and quarter turns of frames and of positions in them, for the equivariance loss (paper section 3.1)."""

import torch
from torch import Tensor


def turned(frames: Tensor, turns: int, mirrored: bool) -> Tensor:
    """(B, 3, H, W) frames mirrored left-right if asked, then turned by `turns` quarter turns."""
    return torch.rot90(frames.flip(-1) if mirrored else frames, turns, (-2, -1))


def turned_along(xy: Tensor, turns: int, mirrored: bool, height: int, width: int) -> Tensor:
    """(..., 2) pixels of a height x width frame as pixels of that frame `turned`."""
    if mirrored:
        xy = torch.stack([width - 1 - xy[..., 0], xy[..., 1]], -1)
    w, h = width, height
    for _ in range(turns % 4):
        x, y = xy.unbind(-1)
        xy = torch.stack([y, w - 1 - x], -1)
        w, h = h, w
    return xy


def turned_back(xy: Tensor, turns: int, mirrored: bool, height: int, width: int) -> Tensor:
    """(..., 2) pixels of a `turned` frame as pixels of the frame before it, which was height x width."""
    h, w = (height, width) if turns % 2 == 0 else (width, height)
    for _ in range(turns % 4):
        x, y = xy.unbind(-1)
        xy = torch.stack([h - 1 - y, x], -1)
        h, w = w, h
    return torch.stack([w - 1 - xy[..., 0], xy[..., 1]], -1) if mirrored else xy
