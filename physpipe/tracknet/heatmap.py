"""From scores on a grid to a distribution, a position and its entropy (paper section 3.1)."""

import torch
from torch import Tensor


def distribution(logits: Tensor) -> Tensor:
    """(B, h, w) scores to (B, h, w) probabilities: the softmax over all cells."""
    return logits.float().flatten(1).softmax(1).view(logits.shape)


def cell_centres(cells: int, stride: int) -> Tensor:
    """(cells,) pixel coordinate of each cell's centre; cell i covers pixels i * stride to (i + 1) * stride - 1."""
    return torch.arange(cells) * stride + (stride - 1) / 2


def expected_position(heat: Tensor, stride: int) -> Tensor:
    """(B, h, w) probabilities to their (B, 2) mean position in pixels, u = sum_v v s_v."""
    xs = cell_centres(heat.shape[2], stride).to(heat)
    ys = cell_centres(heat.shape[1], stride).to(heat)
    # Not a matrix product: autocast would round positions to bfloat16, half a pixel at x = 128.
    return torch.stack([(heat.sum(1) * xs).sum(1), (heat.sum(2) * ys).sum(1)], dim=1)


def entropy(heat: Tensor) -> Tensor:
    """(B,) entropy in nats of (B, h, w) probabilities; log(h w) when flat, 0 when a single cell holds all."""
    # Clamped, since the slope of p log p is infinite at the 0 of a masked cell.
    return -(heat * heat.clamp_min(1e-30).log()).flatten(1).sum(1)
