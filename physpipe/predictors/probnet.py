"""ProbNet: DispNet that also says how sure it is, as a bivariate Gaussian over every position.

Ehrhardt et al. 2018, section 3.2, and arXiv 1706.02179: the covariance is regressed from the state as two bounded
eigenvalues and an angle, and the likelihood of the targets is maximised. Ours: the bounds, a standard deviation that a
sigmoid spreads over them in ratios rather than differences, the time since the last seen frame beside the state, and
first steps that learn the mean alone.
"""

import torch
from pydantic import Field
from torch import Tensor

from physpipe.predictors.base import Forecast, Window, distance_px
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.gaussian import covariance, nll_nats
from physpipe.predictors.layers import zero_reader
from physpipe.predictors.scene import Scene
from physpipe.predictors.tensor_state import TensorStateParams


class ProbNetParams(TensorStateParams):
    """The state, and how a forecast may spread."""

    least_std_px: float = Field(gt=0)
    """Smallest standard deviation along any direction, pixels."""
    largest_std_px: float = Field(gt=0)
    """Largest one."""
    distance_steps: int = Field(ge=0)
    """First steps of a training, in which the loss is the mean distance."""


class ProbNet(DispNet):
    """Uncertainty at a time is read from the state there, not added up."""

    Params = ProbNetParams
    steps: Tensor

    def __init__(self, params: ProbNetParams, objects: int):
        super().__init__(params, objects)
        self.least, self.most = params.least_std_px, params.largest_std_px
        self.distance_steps = params.distance_steps
        self.spread = zero_reader(self.look_size + 1, params.hidden, outputs=3)
        self.register_buffer("steps", torch.tensor(0))

    def _answer(self, scene: Scene, path: Tensor, looks: Tensor, ahead: Tensor) -> Forecast:
        age = ahead.to(looks).log()[:, :, None, None].expand(-1, -1, self.objects, 1)
        raw = self.spread(torch.cat([looks, age], dim=3)).float()
        std = self.least * (self.most / self.least) ** torch.sigmoid(raw[..., :2])
        return Forecast(scene.unit.to_px(path), covariance(std, raw[..., 2]))

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean distance in the first steps, then the mean negative log likelihood in nats."""
        self.steps += 1
        forecast = self(batch.seen, batch.asked_times)
        distance, nll = distance_px(forecast.mean, batch.target), nll_of(forecast, batch.target)
        loss = distance.mean() if self.steps <= self.distance_steps else nll.mean()
        return loss, {"train_last_px": distance[:, -1].mean().item(), "train_nll_nats": nll.mean().item()}

    def validation_loss(self, batch: Window) -> Tensor:
        """The mean negative log likelihood in nats."""
        return nll_of(self(batch.seen, batch.asked_times), batch.target).mean()


def nll_of(forecast: Forecast, target: Tensor) -> Tensor:
    """(B, N, K) negative log density of `target` in nats."""
    assert forecast.cov is not None
    return nll_nats(forecast.mean, forecast.cov, target)
