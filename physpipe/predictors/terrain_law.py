"""The law of motion on a terrain: one frame ahead, read from the terrain's map at the place of each object (ours)."""

from typing import NamedTuple, Self

import torch
from torch import Tensor, nn
from torch.nn.functional import max_pool1d

from physpipe.predictors.contact import CLEAR, Contact
from physpipe.predictors.cushions import Cushions, near_side
from physpipe.predictors.impact import Impact
from physpipe.predictors.kinematics import FASTEST, POWERS, SPEED, change
from physpipe.predictors.layers import bilinear_weights, read_at, reader, zero_linear, zero_reader
from physpipe.predictors.sliding import Sliding


class Motion(NamedTuple):
    """Where the objects are and go; M alternatives of it side by side."""

    place: Tensor
    """(B, M, K, 2) from the frame's centre, half of its longer side being 1."""
    velocity: Tensor
    """(B, M, K, 2) a frame."""
    sliding: Tensor
    """(B, M, K, 2) how much faster it is than it rolls, since it ran into something; a frame."""

    @classmethod
    def rolling(cls, place: Tensor, velocity: Tensor) -> Self:
        """Of objects that have run into nothing."""
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

    def repeated(self, times: int) -> "Scene":
        """Every scene so many times, one after the other."""
        ground, whole, objects = (each.repeat_interleave(times, 0) for each in (self.map, self.whole, self.objects))
        return Scene(ground, whole, objects, self.aspect)


class Law(nn.Module):
    """Acceleration by the ground, quadratic in the velocity as gravity, friction and bends are; and what running into
    another object or a cushion does.

    The coefficients may depend on the velocity and on the place ahead, since a rim turns only what runs into it.
    """

    def __init__(self, channels: int, whole: int, code: int, hidden: int, pairs: bool):
        super().__init__()
        self.ground = zero_reader(2 * channels + whole + code + 4, hidden, 2 * POWERS, nn.SiLU)
        self.direct = zero_linear(channels, 2 * POWERS)
        self.slope = reader(channels, hidden, 2)  # not 0 at first, where its gradient is 0
        self.contact = Contact(channels, code, hidden) if pairs else None
        self.sliding = Sliding(channels, hidden)
        self.cushions = Cushions(whole, code)

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
        if self.contact is None and not self.cushions.present:
            return now._replace(place=now.place + velocity, velocity=velocity)
        impact = self._impact(scene, now.place, velocity)
        slower, sliding = self.sliding(now.sliding + impact.slid, velocity, here, self.slope(here).float())
        place = now.place + velocity + impact.moved + slower
        return Motion(place, (velocity + impact.push + slower).clamp(-FASTEST, FASTEST), sliding)

    def _impact(self, scene: Scene, place: Tensor, velocity: Tensor) -> Impact:
        impact = Impact.none(velocity)
        if self.contact is not None:
            between = (place.unsqueeze(2) + place.unsqueeze(3)).flatten(2, 3) / 2
            ground = read(scene.map, between, scene.aspect).unflatten(2, place.shape[2:3] * 2)
            impact = self.contact(place, velocity, ground, self.slope(ground).float(), scene.objects)
        if self.cushions.present:
            impact = impact.and_of(self.cushions(place, velocity, self._sides(scene)))
        return impact

    def turned(self, scene: Scene, places: Tensor) -> tuple[Tensor, Tensor]:
        """`places` (B, T, K, 2) as if objects had come straight to where they go since a cushion turned them; and
        (B, K, 2) by how much more they slide since."""
        if not self.cushions.present:
            return places, torch.zeros_like(places[:, 0])
        with torch.autocast(places.device.type, enabled=False):
            return self.cushions.turned(places, self._sides(scene))

    def see(self, scene: Scene, track: Tensor) -> Tensor:
        """() how badly cushions, as far as they are known, bound tracks (B, T, K, 2).

        Where there are none, no other part is to learn of it. Takes from the tracks how near objects come to each
        other, too: it is for the time before touches are learned.
        """
        if self.contact is not None:
            self.contact.see_distances(nearest_two(track).amin(1))
        whole, objects = scene.whole, scene.objects
        if not self.cushions.present:
            whole, objects = whole.detach(), objects.detach()
        with torch.autocast(track.device.type, enabled=False):
            return self.cushions.see(track, self.cushions.where(whole, objects))

    def untouched(self, scene: Scene, track: Tensor, width: int) -> Tensor:
        """(B, T - width + 1, 1) 1 where none can have run into anything in the `width` frames of `track` from there."""
        near = torch.zeros_like(track[..., 0, 0])
        if self.contact is not None:
            clear = CLEAR * self.contact.reaches(scene.objects).detach().amax((1, 2))
            near = (nearest_two(track) <= clear[:, None]).to(track)
        if self.cushions.present:
            near = near.maximum(near_side(track, self._sides(scene).detach()).to(track))
        return 1 - max_pool1d(near, width, stride=1).unsqueeze(-1)

    def _sides(self, scene: Scene) -> Tensor:
        return self.cushions.where(scene.whole, scene.objects)


def nearest_two(track: Tensor) -> Tensor:
    """(B, T) distance of the two objects of `track` (B, T, K, 2), K > 1, that are nearest to each other."""
    one, other = torch.triu_indices(track.shape[2], track.shape[2], 1)
    return torch.linalg.vector_norm(track[:, :, one] - track[:, :, other], dim=-1).amin(2)


def read(ground: Tensor, place: Tensor, aspect: Tensor) -> Tensor:
    """(B, M, K, C) of the map (B, C, h, w) at (B, M, K, 2)."""
    weights = bilinear_weights(place.flatten(1, 2), (ground.shape[2], ground.shape[3]), aspect)
    return read_at(ground, weights).unflatten(1, place.shape[1:3])
