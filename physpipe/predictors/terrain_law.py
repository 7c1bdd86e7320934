"""The law of motion on a terrain: one frame ahead, read from the terrain's map at the place of each object (ours)."""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn.functional import max_pool1d

from physpipe.predictors.contact import CLEAR, Contact
from physpipe.predictors.kinematics import FASTEST, POWERS, SPEED, change
from physpipe.predictors.layers import bilinear_weights, read_at, zero_linear, zero_reader


class Motion(NamedTuple):
    """Where the objects are and go; M alternatives of it side by side."""

    place: Tensor
    """(B, M, K, 2) from the frame's centre, half of its longer side being 1."""
    velocity: Tensor
    """(B, M, K, 2) a frame."""
    sliding: Tensor
    """(B, M, K, 2) how much faster it is than it rolls, since it met another; a frame."""

    @classmethod
    def rolling(cls, place: Tensor, velocity: Tensor) -> "Motion":
        """Of objects that have met none."""
        return cls(place, velocity, torch.zeros_like(velocity))


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
    """Acceleration by the ground, quadratic in the velocity as gravity, friction and bends are; and what meetings do.

    The coefficients may depend on the velocity and on the place ahead, since a cushion turns only what runs into it.
    """

    def __init__(self, channels: int, whole: int, code: int, hidden: int, pairs: bool):
        super().__init__()
        self.ground = zero_reader(2 * channels + whole + code + 4, hidden, 2 * POWERS, nn.SiLU)
        self.direct = zero_linear(channels, 2 * POWERS)
        self.contact = Contact(channels, code, hidden) if pairs else None

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
        velocity = (now.velocity + turn).clamp(-FASTEST, FASTEST)  # else the law's square term may run away
        if self.contact is None:
            return now._replace(place=now.place + velocity, velocity=velocity)
        between = (now.place.unsqueeze(2) + now.place.unsqueeze(3)).flatten(2, 3) / 2
        ground = read(scene.map, between, scene.aspect).unflatten(2, now.place.shape[2:3] * 2)
        impact = self.contact(now.place, velocity, ground, scene.objects)
        slower, sliding = self.contact.rolled(now.sliding + impact.slid, velocity, here)
        place = now.place + velocity + impact.moved + slower
        return Motion(place, (velocity + impact.push + slower).clamp(-FASTEST, FASTEST), sliding)

    def see_distances(self, track: Tensor) -> None:
        """Where nothing is learned of touches yet: takes from tracks (B, T, K, 2) how near objects come."""
        if self.contact is not None:
            self.contact.see_distances(nearest_two(track).amin(1))

    def untouched(self, scene: Scene, track: Tensor, width: int) -> Tensor:
        """(B, T - width + 1, 1) 1 where none can have met another in the `width` frames of `track` from there on."""
        if self.contact is None:
            return torch.ones_like(track[:, width - 1 :, :1, 0])
        nearest = -max_pool1d(-nearest_two(track), width, stride=1)
        clear = CLEAR * self.contact.reaches(scene.objects).detach().amax((1, 2))
        return (nearest > clear[:, None]).to(track).unsqueeze(-1)


def nearest_two(track: Tensor) -> Tensor:
    """(B, T) distance of the two objects of `track` (B, T, K, 2), K > 1, that are nearest to each other."""
    one, other = torch.triu_indices(track.shape[2], track.shape[2], 1)
    return torch.linalg.vector_norm(track[:, :, one] - track[:, :, other], dim=-1).amin(2)


def read(ground: Tensor, place: Tensor, aspect: Tensor) -> Tensor:
    """(B, M, K, C) of the map (B, C, h, w) at (B, M, K, 2)."""
    weights = bilinear_weights(place.flatten(1, 2), (ground.shape[2], ground.shape[3]), aspect)
    return read_at(ground, weights).unflatten(1, place.shape[1:3])
