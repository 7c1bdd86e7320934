"""How far forecasts miss, as a power of how far ahead they are: fitted to film that nothing was learned from (ours).

What a predictor that gives no covariance is as sure as; and a part of the covariance of `terrain`.
"""

import torch
from torch import Tensor, nn

from physpipe.predictors.gaussian import SURE


class Misses(nn.Module):
    """The power of time that is nearest to the circles that held 90 % of the held-out misses at each time."""

    law: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("law", torch.full((2,), torch.inf))
        """Infinite before `fit`."""

    @property
    def known(self) -> bool:
        """Whether anything was fitted."""
        return bool(self.law.isfinite().all())

    def forward(self, ahead: Tensor) -> Tensor:
        """(..., 2, 2) px^2 at (...) `ahead` frames from the last seen one."""
        return power(self.law, ahead)[..., None, None] * torch.eye(2, device=ahead.device)

    def fit(self, missed: Tensor, ahead: Tensor) -> None:
        """`missed`: (B, N, K, 2) px at (N,) `ahead` frames from the last seen one."""
        self.law.copy_(fitted(missed.square().sum(-1), ahead))


def fitted(squares: Tensor, ahead: Tensor) -> Tensor:
    """(2,) the `power` of `ahead` (N,) nearest to what brings 90 % of `squares` (B, N, K) of each time below SURE.

    Squared lengths of what is missed, in pixels or in standard deviations; nearest in logarithm.
    """
    needed = squares.float().transpose(1, 2).flatten(0, 1).quantile(0.9, dim=0).clamp_min(torch.finfo().tiny) / SURE
    return torch.linalg.pinv(_terms(ahead)) @ needed.log()


def power(law: Tensor, ahead: Tensor) -> Tensor:
    """(...) exp(a) ahead^b at (...) `ahead`, a and b being `law` (2,)."""
    return (_terms(ahead) @ law).exp()


def _terms(ahead: Tensor) -> Tensor:
    return torch.stack([torch.ones_like(ahead), ahead.log()], dim=-1)
