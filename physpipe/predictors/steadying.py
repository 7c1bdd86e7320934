"""How a hand-held or shaken camera moved between the seen frames, told from what stands still in them (ours)."""

from dataclasses import replace

import torch
from torch import Tensor
from torch.nn import functional as F

from physpipe.predictors.base import Seen

ROUNDS = 3
"""Robust least-squares fits, each without what the last one could not explain: the objects that move."""
EVERY = 2
"""Every so many pixels are compared along x and y."""
MARGIN = 2
"""Pixels at each edge that have no slope."""
FLAT = 1e-4
"""Added to the normal equations: a picture without texture tells no shift."""


def camera_shifts(frames: Tensor) -> Tensor:
    """(B, T, 2) shift of the still scene in each of (B, T, 3, H, W) frames since the last; px, at most about 1."""
    grey = _smooth(frames)
    return _shifts(grey, grey[:, -1:])


def steadied(seen: Seen) -> Seen:
    """The same with all positions as in the last of the frames that they were seen in."""
    if seen.steady:
        return seen
    return replace(seen, xy=seen.xy - camera_shifts(seen.frames).unsqueeze(2), steady=True)


def camera_path(frames: Tensor) -> Tensor:
    """(..., T, 2) px by which the still scene has shifted in each of (..., T, 3, H, W) frames since the first.

    Summed from frame to frame, so errors add up as a random walk.
    """
    grey = _smooth(frames)
    steps = _shifts(grey[..., 1:, :, :], grey[..., :-1, :, :])
    return torch.cat([torch.zeros_like(steps[..., :1, :]), steps.cumsum(-2)], dim=-2)


def _smooth(frames: Tensor) -> Tensor:
    """(..., H - 2, W - 2) brightness of frames (..., 3, H, W), a little smoothed."""
    grey = frames.float().mean(-3)
    return F.avg_pool2d(grey.flatten(0, -3), 3, stride=1).unflatten(0, grey.shape[:-2])


def _shifts(later: Tensor, earlier: Tensor) -> Tensor:
    """(..., 2) px of `later` (..., H, W) since `earlier`, of the same shape but for frames that all have one.

    One step of image registration by gradients (Lucas and Kanade), with gain and offset for drifting light.
    """
    between = (later + earlier) / 2  # slopes half-way: else they would be those of one end
    inner = (..., slice(MARGIN, -MARGIN, EVERY), slice(MARGIN, -MARGIN, EVERY))
    along_x = _slopes(between[..., MARGIN:-MARGIN:EVERY, :])[..., ::EVERY]
    along_y = _slopes(between[..., MARGIN:-MARGIN:EVERY].transpose(-1, -2)).transpose(-1, -2)[..., ::EVERY, :]
    level, change = between[inner], (later - earlier)[inner]
    basis = torch.stack([along_x, along_y, level, torch.ones_like(level)], dim=-1).flatten(-3, -2)
    change = change.flatten(-2).unsqueeze(-1)  # (..., P, 1)
    weight = torch.ones_like(change)
    found = torch.zeros(1)
    for _ in range(ROUNDS):
        weighted = (basis * weight).transpose(-1, -2)
        normal = weighted @ basis + FLAT * torch.eye(4, device=basis.device)
        found = torch.linalg.solve(normal, weighted @ change)
        left = (change - basis @ found).abs()
        weight = (left < 3 * left.mean(-2, keepdim=True)).to(change)
    return -found[..., :2, 0]


def _slopes(image: Tensor) -> Tensor:
    """(..., H, W - 4): slope along x by differences of the fourth order, right for all but the finest texture."""
    near, far = image[..., 3:-1] - image[..., 1:-3], image[..., 4:] - image[..., :-4]
    return (8 * near - far) / 12
