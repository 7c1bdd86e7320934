"""The tracker's losses: causality (paper section 3.1), and the motion warm start (ours)."""

import torch
import torch.nn.functional as F
from torch import Tensor

from physpipe.tracknet.discriminator import MOMENTS, Discriminator, shuffles


def causality(judge: Discriminator, xy: Tensor, weights: Tensor, negatives: int, generator: torch.Generator) -> Tensor:
    """L_disc of (N, 5, 2) positions with (N,) weights that sum to 1; the natural order and its shuffles weigh one half
    each.

    Scoring several shuffles of the same positions has the expectation of the paper's 50/50 coin and far less variance.
    """
    unnatural = F.softplus(judge(shuffled(xy, negatives, generator))).mean(1)
    return 0.5 * (weights * (F.softplus(-judge(xy)) + unnatural)).sum()


def shuffled(xy: Tensor, count: int, generator: torch.Generator) -> Tensor:
    """(N, count, 5, 2): (N, 5, 2) positions in `count` unnatural orders each."""
    orders = shuffles(count, len(xy), generator).to(xy.device)
    return xy[torch.arange(len(xy), device=xy.device)[:, None, None], orders]


def causality_by_coin(judge: Discriminator, xy: Tensor, weights: Tensor, generator: torch.Generator) -> Tensor:
    """L_disc as the paper states it: each (N, 5, 2) trajectory is shuffled with probability one half."""
    orders = shuffles(1, len(xy), generator)[:, 0]
    heads = torch.rand(len(xy), generator=generator) < 0.5
    orders = torch.where(heads[:, None], torch.arange(MOMENTS), orders).to(xy.device)
    logits = judge(xy.gather(1, orders[..., None].expand(-1, -1, 2)))
    return (weights * F.softplus(torch.where(heads.to(xy.device), -logits, logits))).sum()


def motion_target(frames: Tensor, background: Tensor, stride: int) -> Tensor:
    """(B, h, w) distribution of where (B, 3, H, W) frames differ from their clip's background."""
    above = _standing_out(frames, background, stride)
    return above / above.flatten(1).sum(1).clamp_min(1e-12)[:, None, None]


def even_motion_target(frames: Tensor, background: Tensor, stride: int, even: float, nearby_cells: int) -> Tensor:
    """As `motion_target`, but objects of little contrast weigh nearly as much as others.

    Motion is taken relative to the strongest in a square of `nearby_cells`, so that an object's peak stays as sharp as
    it is; `even` is the share of the strongest motion in a frame, on average over the batch, at which a peak counts
    half. A frame in which nothing moves, less than half a cell in all, has a sum below 1, so that its noise teaches
    little.
    """
    above = _standing_out(frames, background, stride)
    strongest = above.flatten(1).max(1).values.mean().clamp_min(1e-12)
    nearby = F.max_pool2d(above[:, None], nearby_cells, stride=1, padding=nearby_cells // 2)[:, 0]
    counted = above / (nearby + even * strongest)
    return counted / counted.flatten(1).sum(1).clamp_min(0.5)[:, None, None]


def _standing_out(frames: Tensor, background: Tensor, stride: int) -> Tensor:
    """(B, h, w) squared residuals less what most of the frame shows (noise, light), squared again."""
    residual = (frames - background).square().mean(1, keepdim=True)
    pooled = F.avg_pool2d(residual, stride)[:, 0]
    floor = pooled.flatten(1).quantile(0.9, dim=1)[:, None, None]
    return (pooled - floor).clamp_min(0).square()


def motion_cross_entropy(logits: Tensor, target: Tensor) -> Tensor:
    """Mean over the batch of the cross-entropy between `target` and the softmax of `logits`, both (B, h, w)."""
    return -(target * logits.flatten(1).log_softmax(1).view(logits.shape)).flatten(1).sum(1).mean()
