"""Mean forecast over the frame's mirrors and turns: physics seen in a mirror is physics (ours)."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import torch
from torch import Tensor

from physpipe.predictors.base import Forecast, Seen


def mean_over_symmetries(forecast: Callable[[Seen, Tensor], Forecast], seen: Seen, asked_times: Tensor) -> Forecast:
    """The mean of `forecast` over the eight symmetries of a square frame, four of any other.

    Mirroring the scene thus mirrors the forecast exactly. Forecasts with a covariance are mixed with equal weights:
    the mixture's own mean and covariance are given back.
    """
    height, width = seen.frames.shape[-2:]
    swaps = (False, True) if height == width else (False,)
    means, covs = [], []
    for flip_x, flip_y, swap in product((False, True), (False, True), swaps):
        frames = seen.frames.flip([axis for axis, flip in ((-1, flip_x), (-2, flip_y)) if flip])
        xy = mirrored(seen.xy, flip_x, flip_y, height, width)
        if swap:
            frames, xy = frames.transpose(-1, -2), xy.flip(-1)
        found = forecast(replace(seen, frames=frames, xy=xy), asked_times)
        means.append(mirrored(found.mean.flip(-1) if swap else found.mean, flip_x, flip_y, height, width))
        if found.cov is not None:
            covs.append(mirrored_cov(found.cov.flip(-1, -2) if swap else found.cov, flip_x, flip_y))
    every = torch.stack(means)
    mean = every.mean(0)
    if not covs:
        return Forecast(mean)
    off = every - mean
    return Forecast(mean, torch.stack(covs).mean(0) + (off.unsqueeze(-1) * off.unsqueeze(-2)).mean(0))


def mirrored(xy: Tensor, flip_x: bool, flip_y: bool, height: int, width: int) -> Tensor:
    """(..., 2) pixels in a frame mirrored in x, in y."""
    x, y = xy.unbind(-1)
    return torch.stack([width - 1 - x if flip_x else x, height - 1 - y if flip_y else y], dim=-1)


def mirrored_cov(cov: Tensor, flip_x: bool, flip_y: bool) -> Tensor:
    """(..., 2, 2) covariance in a frame mirrored in x, in y: one mirror turns the sign of that of x and y."""
    sign = -1.0 if flip_x != flip_y else 1.0
    return cov * torch.tensor([[1.0, sign], [sign, 1.0]], device=cov.device)
