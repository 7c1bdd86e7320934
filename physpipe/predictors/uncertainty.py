"""How sure a forecast by a law of motion is: errors of the start, carried along the path by the law itself (ours).

The law is linearised along the forecast path (as an extended Kalman filter does): what spreads paths makes a forecast
less sure, what gathers them makes it surer, however far ahead. What is seen then also moves with the camera, which
nobody can foresee: little in the next frame, and at most as far as it sways. And the law errs: anew in every frame, and
by what it has got wrong of a scene for good. All of that is fitted to held-out film.
"""

from collections.abc import Callable
from typing import NamedTuple

import torch
from torch import Tensor, nn

from physpipe.predictors.gaussian import determinant, squared_mahalanobis
from physpipe.predictors.misses import fitted, power
from physpipe.predictors.terrain_law import Motion

WIDTH = (1 / 64, 1 / 256, 1 / 256)
"""Steps of the differences in position, velocity and sliding, halves of the frame's longer side: a pixel of 128, then a
quarter of one."""
WILD = 25.0
"""Squared Mahalanobis distance from which a miss counts no more: a lost track would rule the fit."""


class Path(NamedTuple):
    """A forecast path and how small changes travel along it."""

    place: Tensor
    """(B, N, K, 2) halves of the frame's longer side."""
    jacobians: Tensor
    """(B, N, 6 K, 6 K): change of each frame's (places, velocities, slidings) by those of the frame before."""


def linearised(step: Callable[[Motion], Motion], start: Motion, steps: int) -> Path:
    """The path of `start` (B, 1, K, 2), and the law's derivatives along it, by central differences."""
    K = start.place.shape[2]
    widths = torch.tensor(WIDTH).repeat_interleave(2 * K).to(start.place)
    nudges = torch.cat([torch.diag(widths), -torch.diag(widths)])  # (12 K, 6 K)
    now, places, jacobians = start, [], []
    for _ in range(steps):
        around = _joined(now) + torch.cat([torch.zeros_like(nudges[:1]), nudges])  # (B, 1 + 12 K, 6 K)
        later = _joined(step(_parted(around, K)))
        ups, downs = later[:, 1:].chunk(2, dim=1)
        jacobians.append(((ups - downs) / (2 * widths[:, None])).transpose(1, 2))
        now = _parted(later[:, :1], K)
        places.append(now.place[:, 0])
    return Path(torch.stack(places, dim=1), torch.stack(jacobians, dim=1))


class Spread(nn.Module):
    """Nine numbers behind a forecast's covariance; of no use before `fit`."""

    def __init__(self, objects: int):
        super().__init__()
        self.objects = objects
        self.logs = nn.Parameter(torch.tensor([-6.0, -7.0, -8.0, -9.0, -5.0, -4.0, 2.0]), requires_grad=False)
        """Logarithms of standard deviations: position and velocity of the start, change of velocity in a frame and in
        every frame alike, position in a frame, sway of the camera; and of the frames in which the camera sways."""
        self.scale = nn.Parameter(torch.zeros(2), requires_grad=False)
        """What else enlarges the covariance: logarithm of a factor, and a power of the frame."""

    def forward(self, jacobians: Tensor) -> Tensor:
        """(B, N, K, 2, 2) covariances along a path."""
        K = self.objects
        place, velocity, change, always, seen, sway = self.logs[:6].exp().square()
        still = place.new_zeros(2 * K)
        begin = torch.cat([place.expand(2 * K), velocity.expand(2 * K), still])
        cov = torch.diag(begin).expand(len(jacobians), -1, -1)
        noise = torch.diag(torch.cat([still, change.expand(2 * K), still]))
        push = torch.diag(torch.cat([still, torch.ones_like(still), still]))[:, 2 * K : 4 * K]
        pushed, along = torch.zeros_like(push), []
        for J in jacobians.unbind(1):
            cov, pushed = J @ cov @ J.transpose(1, 2) + noise, J @ pushed + push
            along.append(cov + always * pushed @ pushed.transpose(1, 2))
        blocks = torch.stack(along, dim=1)[..., : 2 * K, : 2 * K].unflatten(-2, (K, 2)).unflatten(-1, (K, 2))
        own = torch.diagonal(blocks, dim1=2, dim2=4).movedim(-1, 2)  # (B, N, K, 2, 2)
        ahead = torch.arange(1.0, len(along) + 1, device=own.device)
        around = seen + sway * (1 - torch.exp(-(ahead / self.logs[6].exp()).square()))
        cov = own + around[:, None, None, None] * torch.eye(2, device=own.device)
        return power(self.scale, ahead)[:, None, None, None] * cov

    def fit(self, jacobians: Tensor, missed: Tensor, rounds: int) -> None:
        """To how far forecasts missed, (B, N, K, 2): most likely, then scaled so that 90 % lie in the 90 % ellipse.

        The scale is the power of the frame that comes nearest to what that takes in each.
        """
        nn.init.zeros_(self.scale)
        self.logs.requires_grad_(True)
        optimiser = torch.optim.Adam([self.logs], lr=0.1)
        with torch.enable_grad():
            for _ in range(rounds):
                optimiser.zero_grad()
                cov = self(jacobians)
                loss = (determinant(cov).log() + squared_mahalanobis(missed, cov).clamp(max=WILD)).mean()
                loss.backward()
                optimiser.step()
        self.logs.requires_grad_(False)
        distances = squared_mahalanobis(missed, self(jacobians))
        self.scale.copy_(fitted(distances, torch.arange(1.0, distances.shape[1] + 1, device=distances.device)))


def _joined(motion: Motion) -> Tensor:
    """(B, M, 6 K): all places, then all velocities, then what slides."""
    return torch.cat([each.flatten(2) for each in motion], dim=2)


def _parted(joined: Tensor, objects: int) -> Motion:
    return Motion(*joined.unflatten(2, (3, objects, 2)).unbind(2))
