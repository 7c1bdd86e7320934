"""Bivariate Gaussians: built from eigenvalues and an angle, and judged by their likelihood."""

import math

import torch
from torch import Tensor

LOG_TAU = math.log(2 * math.pi)
SURE = -2 * math.log(1 - 0.9)
"""Squared Mahalanobis distance within which 90 % of a bivariate Gaussian lie."""


def covariance(std: Tensor, angle: Tensor) -> Tensor:
    """(..., 2, 2) with the standard deviations `std` (..., 2) along an axis turned by `angle` (...), and across it."""
    along, across = std.square().unbind(-1)
    middle, half = (along + across) / 2, (along - across) / 2
    lean, slant = half * torch.cos(2 * angle), half * torch.sin(2 * angle)
    return torch.stack([torch.stack([middle + lean, slant], -1), torch.stack([slant, middle - lean], -1)], -2)


def nll_nats(mean: Tensor, cov: Tensor, target: Tensor) -> Tensor:
    """(...) negative log density of `target` (..., 2); `cov` (..., 2, 2). In float64, as flat ellipses need it."""
    return 0.5 * (squared_mahalanobis(target.double() - mean.double(), cov) + determinant(cov).log()) + LOG_TAU


def squared_mahalanobis(missed: Tensor, cov: Tensor) -> Tensor:
    """(...) squared length of `missed` (..., 2) in standard deviations of `cov` (..., 2, 2), in float64."""
    x, y = missed.double().unbind(-1)
    xx, xy, yy = (cov.double()[..., i, j] for i, j in ((0, 0), (0, 1), (1, 1)))
    return (yy * x.square() - 2 * xy * x * y + xx * y.square()) / determinant(cov)


def determinant(cov: Tensor) -> Tensor:
    """(...) of `cov` (..., 2, 2), in float64."""
    cov = cov.double()
    return cov[..., 0, 0] * cov[..., 1, 1] - cov[..., 0, 1].square()
