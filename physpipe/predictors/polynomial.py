"""Extrapolators that learn nothing: stay where you are, and least-squares lines and parabolas through what was seen."""

from typing import ClassVar

import torch
from torch import Tensor

from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen


class NoParams(Section):
    """The extrapolators have nothing to set."""


class Persistence(Predictor):
    """Every object stays at its last seen position: the bar below which a forecast is worth nothing."""

    Params = NoParams
    seen_frames = 4
    objects_alike = True

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        return Forecast(seen.xy[:, -1:].expand(-1, asked_times.shape[1], -1, -1))


class Polynomial(Predictor):
    """Least squares on ten positions, as in the paper (section 3.2), where the networks see four."""

    Params = NoParams
    seen_frames = 10
    objects_alike = True
    degree: ClassVar[int]

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        origin, span = seen.times[:, :1], seen.times[:, -1:] - seen.times[:, :1]  # scaled for a sound solution
        known = self._powers((seen.times - origin) / span)
        asked = self._powers((asked_times - origin) / span)
        fitted = torch.linalg.lstsq(known, seen.xy.double().flatten(2)).solution  # (B, degree + 1, K * 2)
        return Forecast((asked @ fitted).unflatten(2, seen.xy.shape[2:]).to(seen.xy))

    def _powers(self, times: Tensor) -> Tensor:
        return torch.stack([times.double() ** power for power in range(self.degree + 1)], dim=2)


class Linear(Polynomial):
    """Constant velocity."""

    degree = 1


class Quadratic(Polynomial):
    """Constant acceleration."""

    degree = 2
