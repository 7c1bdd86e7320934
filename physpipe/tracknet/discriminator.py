"""The discriminator: does a short trajectory run in its natural order? (paper section 3.1)"""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section

MOMENTS = 5
"""Frames that the paper's discriminator sees at a time."""


class DiscriminatorParams(Section):
    """Size and sight of the discriminator."""

    width: int = Field(ge=4)
    """Units of the two hidden layers (ours; the paper gives only the depth)."""
    shape_only: bool
    """Centre each trajectory and divide it by its RMS, so that place and amplitude tell nothing (ours)."""


class Discriminator(nn.Module):
    """A 3-layer perceptron: (..., 5, 2) pixels to (...,) logits of "in natural order"."""

    def __init__(self, params: DiscriminatorParams, frame_size: float):
        super().__init__()
        self.shape_only = params.shape_only
        self.frame_size = frame_size
        layers = [nn.Linear(2 * MOMENTS, params.width), nn.ReLU(), nn.Linear(params.width, params.width), nn.ReLU()]
        self.judge = nn.Sequential(*layers, nn.Linear(params.width, 1))
        for layer in self.judge:
            if isinstance(layer, nn.Linear):
                nn.init.xavier_uniform_(layer.weight)
                nn.init.zeros_(layer.bias)

    def forward(self, xy: Tensor) -> Tensor:
        seen = _shape(xy) if self.shape_only else 2 * xy / self.frame_size - 1
        with torch.autocast(xy.device.type, enabled=False):  # bfloat16 would blur the order of small moves
            return self.judge(seen.float().flatten(-2)).squeeze(-1)


def _shape(xy: Tensor) -> Tensor:
    centred = xy - xy.mean(-2, keepdim=True)
    size = centred.square().sum(-1, keepdim=True).mean(-2, keepdim=True).sqrt()
    return centred / (size + 1e-3)  # 1e-3 px: far below any motion that could be seen


def shuffles(count: int, batch: int, generator: torch.Generator) -> Tensor:
    """(batch, count, 5) random orders, none of them the natural one or its exact reversal."""
    orders = torch.rand(batch, count, MOMENTS, generator=generator).argsort(-1)
    natural = torch.arange(MOMENTS)
    plain = (orders == natural).all(-1) | (orders == natural.flip(0)).all(-1)
    swapped = torch.tensor([0, 2, 1, 4, 3])  # any fixed unnatural order will do for the 2 in 120
    return torch.where(plain[..., None], swapped, orders)
