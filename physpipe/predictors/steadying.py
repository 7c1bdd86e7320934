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
    """(B, T, 2) shift of the still scene in each of (B, T, 3, H, W) frames since the last, px; for shifts up to a px.

    One step of image registration by gradients (Lucas and Kanade), with gain and offset for drifting light.
    """
    grey = F.avg_pool2d(frames.float().mean(2), 3, stride=1)  # (B, T, H - 2, W - 2); a little smoothing
    between = (grey + grey[:, -1:]) / 2  # slopes half-way: else they would be those of one end
    along_x = _slopes(between)[:, :, MARGIN:-MARGIN:EVERY, ::EVERY]
    along_y = _slopes(between.transpose(2, 3)).transpose(2, 3)[:, :, ::EVERY, MARGIN:-MARGIN:EVERY]
    level, change = (each[:, :, MARGIN:-MARGIN:EVERY, MARGIN:-MARGIN:EVERY] for each in (between, grey - grey[:, -1:]))
    basis = torch.stack([along_x, along_y, level, torch.ones_like(level)], dim=-1).flatten(2, 3)
    change = change.flatten(2).unsqueeze(-1)  # (B, T, P, 1)
    weight = torch.ones_like(change)
    found = torch.zeros(1)
    for _ in range(ROUNDS):
        weighted = (basis * weight).transpose(-1, -2)
        found = torch.linalg.solve(weighted @ basis + FLAT * torch.eye(4, device=frames.device), weighted @ change)
        left = (change - basis @ found).abs()
        weight = (left < 3 * left.mean(2, keepdim=True)).to(change)
    return -found[..., :2, 0]


def steadied(seen: Seen) -> Seen:
    """The same with all positions as in the last of the frames that they were seen in."""
    if seen.steady:
        return seen
    return replace(seen, xy=seen.xy - camera_shifts(seen.frames).unsqueeze(2), steady=True)


def camera_path(frames: Tensor) -> Tensor:
    """(T, 2) px by which the still scene has shifted in each of (T, 3, H, W) frames since the first.

    Summed from frame to frame, so errors add up as a random walk.
    """
    steps = camera_shifts(torch.stack([frames[1:], frames[:-1]], dim=1))[:, 0]
    return torch.cat([steps.new_zeros(1, 2), steps.cumsum(0)])


def _slopes(image: Tensor) -> Tensor:
    """(..., H, W - 4): slope along x by differences of the fourth order, right for all but the finest texture."""
    near, far = image[..., 3:-1] - image[..., 1:-3], image[..., 4:] - image[..., :-4]
    return (8 * near - far) / 12
