"""Friction of a ball that does not roll as fast as it moves (ours).

What runs into something keeps most of its spin, so it slides until friction, which is constant while it slides, has
brought speed and spin together again: a solid ball gives back 2/7 of what it slid by.
"""

import torch
from torch import Tensor, nn

from physpipe.predictors.kinematics import SPEED
from physpipe.predictors.layers import zero_reader
from physpipe.predictors.slopes import length, risen

GRIP = 1 / 512
"""Change of displacement a frame by friction while a ball slides, before anything is learned."""
SLIDE = 3.5
"""By how much of what a solid ball's speed changes its sliding changes."""


class Sliding(nn.Module):
    """Friction is as strong as the ball is pressed on the ground: by gravity, and where the ground bends."""

    def __init__(self, channels: int, hidden: int):
        super().__init__()
        self.press = zero_reader(channels + 2, hidden, 1, nn.SiLU)
        self.grip = nn.Parameter(torch.tensor(GRIP).log())

    def forward(self, sliding: Tensor, velocity: Tensor, here: Tensor, slope: Tensor) -> tuple[Tensor, Tensor]:
        """Change of displacement by friction in a frame, and what `sliding` (B, M, K, 2) is left after it.

        `here` (B, M, K, C) is the ground, `slope` (B, M, K, 2) how steep it is.
        """
        press = self.press(torch.cat([here, velocity / SPEED], dim=-1)).float()
        grip = (self.grip + torch.tanh(press)).exp()
        speed = length(risen(sliding, slope)).unsqueeze(-1)
        change = -grip * torch.tanh(speed / (SLIDE * grip)) * sliding / speed
        return change, sliding + SLIDE * change
