"""The law of motion on a terrain: one frame ahead, read from the terrain's map at the place of each object (ours)."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from physpipe.predictors.kinematics import FASTEST, POWERS, SPEED, change
from physpipe.predictors.layers import bilinear_weights, read_at, zero_linear, zero_reader

NEAR = 0.2
"""A lively distance between two objects, in halves of the frame's longer side."""


class Motion(NamedTuple):
    """Where the objects are and go; M alternatives of it side by side."""

    place: Tensor
    """(B, M, K, 2) from the frame's centre, half of its longer side being 1."""
    velocity: Tensor
    """(B, M, K, 2) a frame."""


class Scene(NamedTuple):
    """All that does not change while objects move."""

    map: Tensor
    """(B, C, h, w)."""
    whole: Tensor
    """(B, D) code of the map."""
    objects: Tensor
    """(B, K, O) codes of the objects."""
    aspect: Tensor
    """(2,) width and height of the frame, half of its longer side being 1."""


class Law(nn.Module):
    """Acceleration by the ground, quadratic in the velocity as gravity, friction and bends are; and by other objects.

    The coefficients may depend on the velocity and on the place ahead, since a cushion turns only what runs into it.
    """

    def __init__(self, channels: int, whole: int, code: int, hidden: int, pairs: bool):
        super().__init__()
        self.ground = zero_reader(2 * channels + whole + code + 4, hidden, 2 * POWERS, nn.SiLU)
        self.direct = zero_linear(channels, 2 * POWERS)
        self.pair = zero_reader(10 + 2 * code, hidden, 2, nn.SiLU) if pairs else None

    def forward(self, scene: Scene, now: Motion) -> Motion:
        """One frame later."""
        with torch.autocast(now.place.device.type, enabled=False):  # a position in bfloat16 is off by a quarter pixel
            return self._step(scene, now)

    def _step(self, scene: Scene, now: Motion) -> Motion:
        M = now.place.shape[1]
        speed = now.velocity / SPEED
        same = torch.cat([scene.whole.unsqueeze(1).expand(-1, scene.objects.shape[1], -1), scene.objects], dim=-1)
        ahead = now.place + now.velocity
        here = read(scene.map, now.place, scene.aspect)
        seen = [here, read(scene.map, ahead, scene.aspect), same.unsqueeze(1).expand(-1, M, -1, -1), now.place, speed]
        turn = change(self.direct(here) + self.ground(torch.cat(seen, dim=-1)), now.velocity)
        if self.pair is not None:
            turn = turn + self._pushes(scene, now)
        velocity = (now.velocity + turn).clamp(-FASTEST, FASTEST)  # else the law's square term may run away
        return Motion(now.place + velocity, velocity)

    def _pushes(self, scene: Scene, now: Motion) -> Tensor:
        """(B, M, K, 2) change of each object's velocity by all others."""
        assert self.pair is not None
        M, K = now.place.shape[1:3]
        apart, closing = (each.unsqueeze(2) - each.unsqueeze(3) for each in now)  # (B, M, K, K, 2): from i to j
        soon = apart + closing
        far, near = (each.square().sum(-1, keepdim=True).add(1e-6).sqrt() / NEAR for each in (apart, soon))
        codes = scene.objects.unsqueeze(1).expand(-1, K, -1, -1)
        both = torch.cat([codes.transpose(1, 2), codes], dim=-1).unsqueeze(1).expand(-1, M, -1, -1, -1)
        told = [apart / NEAR, soon / NEAR, closing / SPEED, apart / NEAR / (far + 0.1), far, near, both]
        push = SPEED * self.pair(torch.cat(told, dim=-1)).float()
        others = 1 - torch.eye(K, device=push.device).unsqueeze(-1)
        return (push * others).sum(3)


def read(ground: Tensor, place: Tensor, aspect: Tensor) -> Tensor:
    """(B, M, K, C) of the map (B, C, h, w) at (B, M, K, 2)."""
    weights = bilinear_weights(place.flatten(1, 2), (ground.shape[2], ground.shape[3]), aspect)
    return read_at(ground, weights).unflatten(1, place.shape[1:3])
