"""A detector and a predictor that learn from each other: the paper's outlook (section 6), without labels as all before.

Where the predictor forecasts an object, the detector should find it: the forecast is a prior on the heat map, and the
distance between the two is a loss of both. Their own losses stay, for agreement alone could be had by always saying the
same place.
"""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.determinism import device
from physpipe.core.params import Section
from physpipe.finetuning.stretches import Batch, Stretch
from physpipe.predictors.base import Predictor, distance_px
from physpipe.tracknet.heatmap import cell_centres, distribution
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.places import around

ELSEWHERE = 1e-3
"""Height of the prior everywhere, beside 1 where an object is forecast: forecasts may be wrong."""


class AgreementParams(Section):
    """What the two are to agree on, and how much that counts beside the losses of their own."""

    looks: int = Field(ge=1)
    """Frames of a stretch, after the seen ones, in which both say where the objects are."""
    window_px: float = Field(gt=0)
    """Radius around the track within which the detector's position is taken."""
    consistency: float = Field(ge=0)
    """Weight of the distance between forecast and finding, a pixel."""
    prior: float = Field(ge=0)
    """Weight of the heat map's cross-entropy with the forecast, a nat; 0 = none."""
    prior_px: float = Field(gt=0)
    """Standard deviation of the forecast as a prior."""


class Joint(nn.Module):
    """Both, with the loss that makes them one."""

    def __init__(self, net: TrackNet, predictor: Predictor, params: AgreementParams):
        super().__init__()
        self.net, self.predictor, self.params = net, predictor, params

    def loss(self, batch: Batch, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """The losses of their own, how far both are apart, and the heat maps' cross-entropy with the forecasts."""
        tracking, parts = self.net.loss(batch.moments, generator)
        with torch.autocast(device().type, enabled=False):  # bfloat16 would round positions
            forecasting, _ = self.predictor.loss(batch.window, generator)
        heat, found = self.find(batch.stretch)
        forecast = self.forecast(batch.stretch)
        apart = distance_px(forecast, found).mean()
        prior = prior_cross_entropy(heat, self.net.detector.stride, forecast.detach(), self.params.prior_px)
        loss = tracking + forecasting + self.params.consistency * apart + self.params.prior * prior
        shown = {"forecasting": forecasting, "apart_px": apart, "prior_nats": prior}
        return loss, parts | {name: value.item() for name, value in shown.items()}

    def find(self, stretch: Stretch) -> tuple[Tensor, Tensor]:
        """Heat maps (B * A, h, w) of the frames looked at, and the (B, A, K, 2) px found in them near the tracks."""
        heat = distribution(self.net.detector(stretch.frames.flatten(0, 1)))
        places = around(heat, self.net.detector.stride, stretch.xy.flatten(0, 1), self.params.window_px)
        return heat, places.xy.view(stretch.xy.shape)

    def forecast(self, stretch: Stretch) -> Tensor:
        """(B, A, K, 2) px forecast for the frames looked at."""
        with torch.autocast(device().type, enabled=False):
            return self.predictor(stretch.window.seen, stretch.times).mean


def prior_cross_entropy(heat: Tensor, stride: int, forecast: Tensor, prior_px: float) -> Tensor:
    """Mean cross-entropy, nats, of heat maps (N, h, w) with a bump around each of their (..., K, 2) px forecast.

    Bumps are 1 high and `prior_px` wide: 0 for a heat map that lies where objects are forecast.
    """
    places = forecast.reshape(len(heat), -1, 2)
    xs, ys = (cell_centres(count, stride).to(heat) for count in (heat.shape[2], heat.shape[1]))
    squared = (xs - places[..., :1]).square()[:, :, None] + (ys - places[..., 1:]).square()[..., None]  # (N, K, h, w)
    bumps = (-squared / (2 * prior_px**2)).exp().amax(1)
    return -(heat * (bumps + ELSEWHERE).log()).sum((1, 2)).mean()
