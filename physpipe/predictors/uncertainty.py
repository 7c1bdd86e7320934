"""How sure a forecast by a law of motion is: errors of the start, carried along the path by the law itself (ours).

The law is linearised along the forecast path (as an extended Kalman filter does): what spreads paths makes a forecast
less sure, what gathers them makes it surer, however far ahead. What is seen then also moves with the camera, which
nobody can foresee: little in the next frame, and at most as far as it sways. All of that is fitted to held-out film.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import torch
from torch import Tensor, nn

from physpipe.predictors.gaussian import determinant, squared_mahalanobis
from physpipe.predictors.terrain_law import Motion

WIDTH = (1 / 64, 1 / 256)
"""Steps of the differences in position and velocity, halves of the frame's longer side: a pixel, a quarter of one."""
SURE = -2 * math.log(1 - 0.9)
"""Squared Mahalanobis distance within which 90 % of a bivariate Gaussian lie."""
WILD = 25.0
"""Squared Mahalanobis distance from which a miss counts no more: a lost track would rule the fit."""


class Path(NamedTuple):
    """A forecast path and how small changes travel along it."""

    place: Tensor
    """(B, N, K, 2) halves of the frame's longer side."""
    jacobians: Tensor
    """(B, N, 4 K, 4 K): change of each frame's (places, velocities) by those of the frame before."""


def linearised(step: Callable[[Motion], Motion], start: Motion, steps: int) -> Path:
    """The path of `start` (B, 1, K, 2), and the law's derivatives along it, by central differences."""
    K = start.place.shape[2]
    widths = torch.cat([torch.full((2 * K,), WIDTH[0]), torch.full((2 * K,), WIDTH[1])]).to(start.place)
    nudges = torch.cat([torch.diag(widths), -torch.diag(widths)])  # (8 K, 4 K)
    now, places, jacobians = start, [], []
    for _ in range(steps):
        around = _joined(now) + torch.cat([torch.zeros_like(nudges[:1]), nudges])  # (B, 1 + 8 K, 4 K)
        later = _joined(step(_parted(around, K)))
        ups, downs = later[:, 1:].chunk(2, dim=1)
        jacobians.append(((ups - downs) / (2 * widths[:, None])).transpose(1, 2))
        now = _parted(later[:, :1], K)
        places.append(now.place[:, 0])
    return Path(torch.stack(places, dim=1), torch.stack(jacobians, dim=1))


class Spread(nn.Module):
    """Six numbers behind a forecast's covariance; of no use before `fit`."""

    def __init__(self, objects: int):
        super().__init__()
        self.objects = objects
        self.logs = nn.Parameter(torch.tensor([-6.0, -7.0, -8.0, -5.0, -4.0, 2.0]), requires_grad=False)
        """Logarithms of standard deviations: position and velocity of the start, change of velocity a frame, position
        in a frame, sway of the camera; and of the frames in which the camera sways."""

    def forward(self, jacobians: Tensor) -> Tensor:
        """(B, N, K, 2, 2) covariances along a path."""
        K = self.objects
        place, velocity, change, seen, sway = self.logs[:5].exp().square()
        cov = torch.diag(torch.cat([place.expand(2 * K), velocity.expand(2 * K)])).expand(len(jacobians), -1, -1)
        noise = torch.diag(torch.cat([change.new_zeros(2 * K), change.expand(2 * K)]))
        along = []
        for J in jacobians.unbind(1):
            cov = J @ cov @ J.transpose(1, 2) + noise
            along.append(cov)
        blocks = torch.stack(along, dim=1)[..., : 2 * K, : 2 * K].unflatten(-2, (K, 2)).unflatten(-1, (K, 2))
        own = torch.diagonal(blocks, dim1=2, dim2=4).movedim(-1, 2)  # (B, N, K, 2, 2)
        ahead = torch.arange(1.0, len(along) + 1, device=own.device) / self.logs[5].exp()
        around = seen + sway * (1 - torch.exp(-ahead.square()))
        return own + around[:, None, None, None] * torch.eye(2, device=own.device)

    def fit(self, jacobians: Tensor, missed: Tensor, rounds: int) -> None:
        """To how far forecasts missed, (B, N, K, 2): most likely, then scaled so that 90 % lie in the 90 % ellipse."""
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
        self.logs[:5].add_(0.5 * (distances.flatten().quantile(0.9) / SURE).log())


def _joined(motion: Motion) -> Tensor:
    """(B, M, 4 K): all places, then all velocities."""
    return torch.cat([motion.place.flatten(2), motion.velocity.flatten(2)], dim=2)


def _parted(joined: Tensor, objects: int) -> Motion:
    place, velocity = joined.unflatten(2, (2, objects, 2)).unbind(2)
    return Motion(place, velocity)
