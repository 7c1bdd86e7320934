"""Lengths on a slope: seen from above, a way along it is longer than it looks, for it also rises (ours)."""

import torch
from torch import Tensor

TINY = 1e-6
"""Added to squared lengths, so that none is 0: the square of a sixteenth of a pixel of 128."""


def risen(way: Tensor, slope: Tensor) -> Tensor:
    """(..., 3) of `way` (..., 2), seen from above, on a ground of `slope` (..., 2): the third is how far it rises."""
    return torch.cat([way, (slope * way).sum(-1, keepdim=True)], dim=-1)


def length(way: Tensor) -> Tensor:
    """(...) of (..., 3), with a finite gradient at 0."""
    return (way.square().sum(-1) + TINY).sqrt()
