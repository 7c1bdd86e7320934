"""What objects do to each other when they meet: a push along the line between them (ours).

Two balls that run into each other push along the line between their middles, by as much as momentum and the restitution
of their kind ask for (Newton's law of impact). Most of their spin stays what it was, so each slides from there on.
"""

import torch
from torch import Tensor, nn

from physpipe.predictors.impact import Impact, certain
from physpipe.predictors.layers import zero_linear, zero_reader
from physpipe.predictors.slopes import TINY, length, risen

REACH = 0.2
"""Distance of the middles when two objects touch, before anything is learned; halves of the frame's longer side."""
RESTITUTION = 0.8
"""Speed of parting over speed of meeting, before anything is learned."""
KEPT = 0.8
"""Share of a push that a ball slides by, before anything is learned; what presses it on the ground spins it, too."""
SEEING = 0.02
"""Share of a batch in what is known of how near objects come."""
SHORT = 1.3
"""By how much the reach may look shorter on a slope."""
CLEAR = 1.2
"""Objects so many times as far apart as they reach do not touch, whatever the noise of their tracks."""
FEW = 0.05
"""Share of the nearest in a batch that says nothing: tracks that are mixed up may coincide."""
GRAZING = 1e-3
"""Share of a frame by which touches are smeared, so that grazing ones have a finite gradient."""


class Contact(nn.Module):
    """Which pairs touch, where, and how hard; codes tell objects apart. Lengths are those along the ground."""

    def __init__(self, channels: int, code: int, hidden: int):
        super().__init__()
        self.ground = zero_reader(channels, hidden, 2, nn.SiLU)
        self.size = zero_linear(code, 1, bias=False)
        self.weight = zero_linear(code, 1, bias=False)
        self.reach = nn.Parameter(torch.tensor(REACH).log())
        self.bounce = nn.Parameter(torch.tensor(RESTITUTION).logit())
        self.spin = nn.Parameter(torch.tensor(KEPT).logit())

    def forward(self, place: Tensor, displacement: Tensor, between: Tensor, slope: Tensor, codes: Tensor) -> Impact:
        """`place`, `displacement`: (B, M, K, 2); `between`: (B, M, K, K, C) ground, `slope` (B, M, K, K, 2) of it;
        `codes`: (B, K, D)."""
        apart, closing = (each.unsqueeze(2) - each.unsqueeze(3) for each in (place, displacement))  # from i to j
        heavy = self.weight(codes).float().squeeze(-1)
        share = torch.sigmoid(heavy.unsqueeze(1) - heavy.unsqueeze(2)).unsqueeze(1)  # of j in the mass of both
        reach = self.reaches(codes).unsqueeze(1)
        harder, spinning = torch.tanh(self.ground(between).float()).unbind(-1)
        when, nearest = _touch(risen(apart, slope), risen(closing, slope), reach)
        line = risen(apart + when.unsqueeze(-1) * closing, slope)
        line = line / length(line).unsqueeze(-1)
        meeting = certain(reach - nearest) * torch.relu(-(risen(closing, slope) * line).sum(-1))
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


def _touch(apart: Tensor, closing: Tensor, reach: Tensor) -> tuple[Tensor, Tensor]:
    """When in the frame, from 0 to 1, two that are `apart` (..., 3) are at `reach`; and how near they come in it."""
    square = closing.square().sum(-1) + TINY
    along = (apart * closing).sum(-1) / square
    nearest = length(apart + (-along).clamp(0, 1).unsqueeze(-1) * closing)
    root = torch.relu(along.square() - (apart.square().sum(-1) - reach.square()) / square)
    return (-along - (root + GRAZING**2).sqrt() + GRAZING).clamp(0, 1), nearest
