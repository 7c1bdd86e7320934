"""What objects do to each other when they meet: a push along the line between them, and spin that fades (ours).

Two balls that run into each other push along the line between their middles, by as much as momentum and the restitution
of their kind ask for (Newton's law of impact). Most of their spin stays what it was, so each slides until friction,
which is constant while it slides, has brought speed and spin together again: a solid ball gives back 2/7 of what it
slid by.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from physpipe.predictors.kinematics import SPEED
from physpipe.predictors.layers import reader, zero_linear, zero_reader

REACH = 0.2
"""Distance of the middles when two objects touch, before anything is learned; halves of the frame's longer side."""
SOFT = 1 / 128
"""Distance over which a touch would be ever more certain, for gradients alone: half a pixel of 128."""
RESTITUTION = 0.8
"""Speed of parting over speed of meeting, before anything is learned."""
KEPT = 0.8
"""Share of a push that a ball slides by, before anything is learned; what presses it on the ground spins it, too."""
GRIP = 1 / 512
"""Change of displacement a frame by friction while a ball slides, before anything is learned."""
SLIDE = 3.5
"""By how much of what a solid ball's speed changes its sliding changes."""
SEEING = 0.02
"""Share of a batch in what is known of how near objects come."""
SHORT = 1.3
"""By how much the reach may look shorter on a slope."""
CLEAR = 1.2
"""Objects so many times as far apart as they reach do not touch, whatever the noise of their tracks."""
FEW = 0.05
"""Share of the nearest in a batch that says nothing: tracks that are mixed up may coincide."""
TINY = 1e-6
"""Added to squared lengths, so that none is 0: the square of a sixteenth of a pixel of 128."""
GRAZING = 1e-3
"""Share of a frame by which touches are smeared, so that grazing ones have a finite gradient."""


class Impact(NamedTuple):
    """What meeting others does to every object within a frame."""

    push: Tensor
    """(B, M, K, 2) change of the displacement."""
    moved: Tensor
    """(B, M, K, 2) by how much more it is displaced in this frame: what is left of it after the touch."""
    slid: Tensor
    """(B, M, K, 2) how much more it slides."""


class Contact(nn.Module):
    """Which pairs touch, where, and how hard; codes tell objects apart.

    Seen from above, a way along a slope is longer than it looks: it also rises. So lengths and pushes are measured with
    the rise, which is read from the ground.
    """

    def __init__(self, channels: int, code: int, hidden: int):
        super().__init__()
        self.slope = reader(channels, hidden, 2)  # not 0 at first, where its gradient is 0
        self.ground = zero_reader(channels, hidden, 2, nn.SiLU)
        self.size = zero_linear(code, 1, bias=False)
        self.weight = zero_linear(code, 1, bias=False)
        self.press = zero_reader(channels + 2, hidden, 1, nn.SiLU)
        self.reach = nn.Parameter(torch.tensor(REACH).log())
        self.bounce = nn.Parameter(torch.tensor(RESTITUTION).logit())
        self.grip = nn.Parameter(torch.tensor(GRIP).log())
        self.spin = nn.Parameter(torch.tensor(KEPT).logit())

    def forward(self, place: Tensor, displacement: Tensor, between: Tensor, codes: Tensor) -> Impact:
        """`place`, `displacement`: (B, M, K, 2); `between`: (B, M, K, K, C) ground; `codes`: (B, K, D)."""
        apart, closing = (each.unsqueeze(2) - each.unsqueeze(3) for each in (place, displacement))  # from i to j
        heavy = self.weight(codes).float().squeeze(-1)
        share = torch.sigmoid(heavy.unsqueeze(1) - heavy.unsqueeze(2)).unsqueeze(1)  # of j in the mass of both
        slope, reach = self.slope(between).float(), self.reaches(codes).unsqueeze(1)
        harder, spinning = torch.tanh(self.ground(between).float()).unbind(-1)
        when, nearest = _touch(_risen(apart, slope), _risen(closing, slope), reach)
        line = _risen(apart + when.unsqueeze(-1) * closing, slope)
        line = line / _length(line).unsqueeze(-1)
        meeting = _met(nearest, reach) * torch.relu(-(_risen(closing, slope) * line).sum(-1))
        meeting = meeting * (1 - torch.eye(place.shape[2], device=place.device))
        push = -((1 + torch.sigmoid(self.bounce + harder)) * share * meeting).unsqueeze(-1) * line[..., :2]
        left, kept = (1 - when).unsqueeze(-1), torch.sigmoid(self.spin + spinning).unsqueeze(-1)
        return Impact(push.sum(3), (left * push).sum(3), (kept * push).sum(3))

    def reaches(self, codes: Tensor) -> Tensor:
        """(B, K, K) distance of the middles at which each two of `codes` (B, K, D) touch."""
        large = self.size(codes).float().squeeze(-1)
        return (self.reach + torch.tanh(large.unsqueeze(1) + large.unsqueeze(2))).exp()

    @torch.no_grad()
    def see_distances(self, nearest: Tensor) -> None:
        """Moves the reach towards how `nearest` (B,) any two came in stretches of film: else it may be far too short
        to be learned."""
        seen = SHORT * torch.quantile(nearest, FEW).clamp_min(TINY)
        self.reach.lerp_(seen.log(), SEEING)

    def rolled(self, sliding: Tensor, velocity: Tensor, here: Tensor) -> tuple[Tensor, Tensor]:
        """Change of displacement by friction in a frame, and what `sliding` (B, M, K, 2) is left after it.

        Friction is as strong as the ball is pressed on the ground `here` (B, M, K, C): by gravity, and where it bends.
        """
        press = self.press(torch.cat([here, velocity / SPEED], dim=-1)).float()
        grip = (self.grip + torch.tanh(press)).exp()
        speed = _length(_risen(sliding, self.slope(here).float())).unsqueeze(-1)
        change = -grip * torch.tanh(speed / (SLIDE * grip)) * sliding / speed
        return change, sliding + SLIDE * change


def _touch(apart: Tensor, closing: Tensor, reach: Tensor) -> tuple[Tensor, Tensor]:
    """When in the frame, from 0 to 1, two that are `apart` (..., 3) are at `reach`; and how near they come in it."""
    square = closing.square().sum(-1) + TINY
    along = (apart * closing).sum(-1) / square
    nearest = _length(apart + (-along).clamp(0, 1).unsqueeze(-1) * closing)
    root = torch.relu(along.square() - (apart.square().sum(-1) - reach.square()) / square)
    return (-along - (root + GRAZING**2).sqrt() + GRAZING).clamp(0, 1), nearest


def _met(nearest: Tensor, reach: Tensor) -> Tensor:
    """1 where two came within their reach, else 0; with the gradient of a soft step, which the reach is learned by."""
    soft = torch.sigmoid((reach - nearest) / SOFT)
    return soft + ((nearest < reach).to(soft) - soft).detach()


def _risen(way: Tensor, slope: Tensor) -> Tensor:
    """(..., 3) of `way` (..., 2), seen from above, on a ground of `slope` (..., 2): the third is how far it rises."""
    return torch.cat([way, (slope * way).sum(-1, keepdim=True)], dim=-1)


def _length(way: Tensor) -> Tensor:
    """(...) of (..., 3), with a finite gradient at 0."""
    return (way.square().sum(-1) + TINY).sqrt()
