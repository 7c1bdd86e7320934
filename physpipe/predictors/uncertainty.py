"""How sure a forecast by a law of motion is: errors of the start, carried along the path by the law itself (ours).

Paths that start a little off show where errors of the start lead (as the sigma points of an unscented Kalman filter
do): what spreads paths makes a forecast less sure, what gathers them makes it surer, however far ahead. All else that
forecasts miss by, such as the law's own errors and the camera's sway, is alike in all directions and grows as a power
of time. All of that is fitted to held-out film.
"""

import torch
from torch import Tensor, nn

from physpipe.predictors.gaussian import determinant, squared_mahalanobis
from physpipe.predictors.misses import fitted, power
from physpipe.predictors.terrain_law import Motion

WIDTHS = (1 / 64, 1 / 256)
"""By how much starts are off in place and in velocity, halves of the frame's longer side: a pixel of 128, and a quarter
of one a frame. As much as they are in truth, so that what is a near miss on one path may be a touch on another."""
WILD = 25.0
"""Squared Mahalanobis distance from which a miss counts no more: a lost track would rule the fit."""


def around(start: Motion) -> Motion:
    """(B, 8 K, K, 2) starts beside `start` (B, 1, K, 2): each coordinate of a place or of a velocity raised, then each
    lowered."""
    K = start.place.shape[2]
    each = torch.eye(2 * K, device=start.place.device).unflatten(1, (K, 2))
    none = torch.zeros_like(each)
    place, velocity = WIDTHS[0] * torch.cat([each, none]), WIDTHS[1] * torch.cat([none, each])
    return Motion(
        start.place + torch.cat([place, -place]),
        start.velocity + torch.cat([velocity, -velocity]),
        start.sliding.expand(-1, 8 * K, -1, -1),
    )


def carried(paths: Tensor) -> Tensor:
    """(B, N, 4 K, K, 2) change of places, by that of each coordinate of the start, along the `paths` (B, N, 8 K, K, 2)
    of starts `around` one."""
    raised, lowered = paths.chunk(2, dim=2)
    widths = torch.tensor(WIDTHS, device=paths.device).repeat_interleave(paths.shape[2] // 4)
    return (raised - lowered) / (2 * widths[:, None, None])


class Spread(nn.Module):
    """Six numbers behind a forecast's covariance; of no use before `fit`."""

    def __init__(self) -> None:
        super().__init__()
        self.start = nn.Parameter(torch.tensor([-7.0, -7.0]), requires_grad=False)
        """Logarithms of the standard deviations of the start's position and velocity."""
        self.rest = nn.Parameter(torch.zeros(2), requires_grad=False)
        """The `power` of time that is the variance of all else."""
        self.scale = nn.Parameter(torch.zeros(2), requires_grad=False)
        """The `power` of time that enlarges both."""

    def forward(self, carried: Tensor) -> Tensor:
        """(B, N, K, 2, 2) covariances along a path, from what is `carried` (B, N, 4 K, K, 2) along it."""
        variances = (2 * self.start).exp().repeat_interleave(carried.shape[2] // 2)
        own = torch.einsum("bnmkx,m,bnmky->bnkxy", carried, variances, carried)
        ahead = torch.arange(1.0, carried.shape[1] + 1, device=own.device)
        rest = power(self.rest, ahead)[:, None, None, None] * torch.eye(2, device=own.device)
        return power(self.scale, ahead)[:, None, None, None] * (own + rest)

    def fit(self, carried: Tensor, missed: Tensor, rounds: int) -> None:
        """To how far forecasts missed, (B, N, K, 2): most likely, then scaled so that 90 % lie in the 90 % ellipse.

        The scale is the power of the frame that comes nearest to what that takes in each. Begins with circles that hold
        90 %, since misses far outside would count no more.
        """
        ahead = torch.arange(1.0, missed.shape[1] + 1, device=missed.device)
        nn.init.zeros_(self.scale)
        self.rest.copy_(fitted(missed.square().sum(-1), ahead))
        learned = [self.start.requires_grad_(True), self.rest.requires_grad_(True)]
        optimiser = torch.optim.LBFGS(learned, max_iter=rounds, line_search_fn="strong_wolfe")

        def unlikely() -> Tensor:
            optimiser.zero_grad()
            cov = self(carried)
            loss = (determinant(cov).log() + squared_mahalanobis(missed, cov).clamp(max=WILD)).mean()
            loss.backward()
            return loss

        with torch.enable_grad():
            optimiser.step(unlikely)
        self.requires_grad_(False)
        self.scale.copy_(fitted(squared_mahalanobis(missed, self(carried)), ahead))
