"""Straight walls along the sides of the frame, as those of a table, and what they do to what runs into one (ours).

A cushion pushes straight away from itself, by as much as its restitution asks for (Newton's law of impact). It spins
nothing, so a ball slides from there on. Whether a scene has cushions is seen in the tracks: where objects come as far
out as they ever do, they are turned at once, and not by and by.
"""

import torch
from torch import Tensor, nn

from physpipe.predictors.impact import Impact, certain
from physpipe.predictors.layers import zero_linear
from physpipe.predictors.turned import unfolded

REACH = 0.7
"""Distance of the sides from the frame's middle, before anything is learned; halves of the frame's longer side."""
RESTITUTION = 0.8
"""Speed away over speed towards, before anything is learned."""
KEPT = 0.9
"""Share of a push that a ball slides by, before anything is learned."""
RARE = 0.005
"""Share of all frames in which an object is beyond a side: noise takes it there in a frame of a touch."""
NEAR = 0.05
"""An object that is further from a side does not touch it, whatever the noise of its track."""
STRETCH = 8
"""Frames in which a turn at once is told from one by and by, which is the nearest parabola in time."""
SEEING = 0.05
"""Share of a batch in what is known of how often objects are turned at once."""
OFTEN = 0.25
"""Share of the stretches near a side with a touch in them from which on there are cushions: of a table seven in ten
have one, on smooth ground one in a hundred."""
STILL = 1e-6
"""Added to speeds, so that none is 0."""


class Cushions(nn.Module):
    """Where the four sides are, for every object, since large ones turn earlier; and how hard they are."""

    share: Tensor

    def __init__(self, whole: int, code: int):
        super().__init__()
        self.sides = zero_linear(whole, 4, bias=False)
        self.size = zero_linear(code, 1, bias=False)
        self.reach = nn.Parameter(torch.tensor(REACH).log())
        self.bounce = nn.Parameter(torch.tensor(RESTITUTION).logit())
        self.spin = nn.Parameter(torch.tensor(KEPT).logit())
        self.register_buffer("share", torch.tensor(0.0))

    @property
    def present(self) -> bool:
        """Whether there are any, as far as tracks tell."""
        return bool(self.share > OFTEN)

    def forward(self, place: Tensor, displacement: Tensor, sides: Tensor) -> Impact:
        """`place`, `displacement`: (B, M, K, 2); `sides`: those of `where`."""
        first, last = sides.unsqueeze(1).unbind(-2)
        ahead = torch.where(displacement > 0, last - place, place + first)
        speed = displacement.abs()
        left = 1 - (ahead / (speed + STILL)).clamp(0, 1)
        push = -(1 + torch.sigmoid(self.bounce)) * certain(speed - ahead) * displacement
        return Impact(push, left * push, torch.sigmoid(self.spin) * push)

    def where(self, whole: Tensor, codes: Tensor) -> Tensor:
        """(B, K, 2, 2) how far from the frame's middle each of `codes` (B, K, D) turns, in a scene of code `whole`
        (B, C): left and up, then right and down."""
        sides = self.sides(whole).float().unflatten(-1, (2, 2)).unsqueeze(1)
        return (self.reach + torch.tanh(sides) - torch.tanh(self.size(codes).float()).unsqueeze(-1)).exp()

    def turned(self, places: Tensor, sides: Tensor) -> tuple[Tensor, Tensor]:
        """`places` (B, T, K, 2) as if objects had come straight to where they go since a side turned them, if one did;
        and (B, K, 2) by how much more they slide since."""
        path, push, _ = unfolded(places, sides, torch.sigmoid(self.bounce))
        return path, torch.sigmoid(self.spin) * push

    def see(self, track: Tensor, sides: Tensor) -> Tensor:
        """How badly `sides` bound `track` (B, T, K, 2): least where objects are beyond one in RARE of all frames.

        Takes note of how often those near a side are turned at once, too.
        """
        beyond = _beyond(track, sides)
        self._watch(track, sides.detach(), beyond.detach())
        return torch.maximum((1 - RARE) * beyond, -RARE * beyond).mean()

    @torch.no_grad()
    def _watch(self, track: Tensor, sides: Tensor, beyond: Tensor) -> None:
        frames = min(STRETCH, track.shape[1])
        stretches = track.unfold(1, frames, 1).movedim(-1, 2).flatten(0, 1)  # (B N, T, K, 2)
        near = beyond.unfold(1, frames, 1)[..., 1:-1].amax((-3, -1)).flatten(0, 1) > -NEAR  # inside, not at the ends
        around = sides.repeat_interleave(len(stretches) // len(sides), 0)
        touched = unfolded(stretches, around, torch.sigmoid(self.bounce), powers=2).touched
        if near.any():
            self.share.lerp_(touched[near].float().mean(), SEEING)


def near_side(track: Tensor, sides: Tensor) -> Tensor:
    """(B, T) whether any of `track` (B, T, K, 2) may touch a side in that frame."""
    return _beyond(track, sides).amax((2, 3, 4)) > -NEAR


def _beyond(track: Tensor, sides: Tensor) -> Tensor:
    """(B, T, K, 2, 2) how far `track` (B, T, K, 2) is beyond each side, negative inside."""
    return torch.stack([-track, track], dim=-2) - sides.unsqueeze(1)
