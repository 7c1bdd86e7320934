"""Noise by which a detector locks on an object instead of telling the order by sub-pixel shifts (ours)."""

import math

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section

COIN_NATS = math.log(2)
"""Loss of a discriminator that cannot tell."""
MEMORY = 0.05
"""Share of the newest loss in the running one."""


class BottleneckParams(Section):
    """Noise on the positions that the discriminator sees; flat heat maps cannot carry a signal through it (ours)."""

    start_px: float = Field(ge=0)
    """Standard deviation at the first step."""
    end_px: float = Field(ge=0)
    """Largest standard deviation; 0 switches the noise off and every loss to its full weight at once."""
    growth: float = Field(gt=1)
    """Factor a step while the discriminator wins; its inverse while it loses."""
    winning: float = Field(gt=0)
    """Running L_disc in nats below which the discriminator wins (a coin has 0.693)."""


class Bottleneck(nn.Module):
    """Noise that grows while the discriminator wins, and the loss by which it wins."""

    sigma: Tensor
    running: Tensor

    def __init__(self, params: BottleneckParams):
        super().__init__()
        self.params = params
        self.register_buffer("sigma", torch.tensor(params.start_px))
        self.register_buffer("running", torch.tensor(COIN_NATS))

    def restart(self) -> None:
        """Sets the schedule back to the first step."""
        self.sigma.fill_(self.params.start_px)
        self.running.fill_(COIN_NATS)

    def forward(self, xy: Tensor, generator: torch.Generator) -> Tensor:
        """Positions (..., 2) px with the noise of today; as they are where it is switched off."""
        if not self.params.end_px:
            return xy
        return xy + self.sigma * torch.randn(xy.shape, generator=generator).to(xy)

    def ramp(self) -> Tensor:
        """How much of the sharpening losses' weight is on: nothing sharpens before the order can be told."""
        end = self.params.end_px
        return self.sigma / end if end else torch.ones_like(self.sigma)

    def adapt(self, order_nats: float) -> None:
        """More noise after a step with a discriminator that wins, else less."""
        params = self.params
        self.running.lerp_(torch.tensor(order_nats).to(self.running), MEMORY)
        if params.end_px:
            wins = bool(self.running < params.winning)
            self.sigma.mul_(params.growth if wins else 1 / params.growth)
            self.sigma.clamp_(params.start_px, params.end_px)
