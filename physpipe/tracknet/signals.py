"""What can be known of a detector without labels: the signals behind the choice of a start and `locked`."""

from dataclasses import dataclass

import torch
from pydantic import Field
from torch import Tensor

from physpipe.core.params import Section
from physpipe.tracknet.heatmap import cell_centres, distribution
from physpipe.tracknet.losses import causality, shuffled
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.moments import Moments, masked


class SignalParams(Section):
    """How the signals are read and weighed."""

    noise_px: float = Field(ge=0)
    """Noise on the positions that the discriminator judges, the same for every start."""
    batches: int = Field(ge=1)
    """Held-out batches to read them from."""
    siamese_weight: float = Field(ge=0)
    """Nats that a pixel of equivariance error costs in the score."""
    near_px: float = Field(gt=0)
    """Radius around the detection within which motion counts as its own."""


@dataclass(frozen=True)
class Signals:
    """Means over held-out batches."""

    order_nats: float
    """The discriminator's loss; a coin has 0.693."""
    order_accuracy: float
    """Share of natural and shuffled orders told apart, each weighing half; a coin has 0.5."""
    siamese_px: float
    """Root mean square error of equivariance to quarter turns."""
    entropy_nats: float
    """Entropy of the heat map; log of the number of cells when flat."""
    motion_share: float
    """Share of the frame's motion residual that lies near the detection."""
    extent_px: float
    """Median root mean square distance of a clip's detections from their mean: 0 for a static spot."""

    def score(self, params: SignalParams) -> float:
        """Lower is better; chooses among starts and checkpoints that are locked alike."""
        return self.order_nats + params.siamese_weight * self.siamese_px


class LockParams(Section):
    """Bounds that all signals must keep for `locked: true`."""

    order_accuracy: float = Field(ge=0, le=1)
    """Smallest share of orders told apart."""
    siamese_px: float = Field(gt=0)
    """Largest equivariance error."""
    entropy_nats: float = Field(gt=0)
    """Largest entropy of the heat map."""
    motion_share: float = Field(ge=0, le=1)
    """Smallest share of motion near the detection."""
    extent_px: float = Field(ge=0)
    """Smallest extent of a trajectory."""


LARGEST = ("siamese_px", "entropy_nats")
"""Bounds that are the largest that locks; the others are the smallest."""


def keeps(key: str, value: float, bounds: LockParams) -> bool:
    """Whether the signal `key` keeps its bound."""
    bound = getattr(bounds, key)
    return value <= bound if key in LARGEST else value >= bound


def locked(signals: Signals, bounds: LockParams) -> bool:
    """Whether the detector follows something that moves, judged without labels."""
    return all(keeps(key, getattr(signals, key), bounds) for key in LockParams.model_fields)


@torch.no_grad()
def read_signals(net: TrackNet, batches: list[Moments], params: SignalParams, generator: torch.Generator) -> Signals:
    """Signals of `net`, which must be in evaluation mode, on held-out batches."""
    rows = [_of_batch(net, each, params, generator) for each in batches]
    mean = {name: float(torch.stack([row[name] for row in rows]).mean()) for name in rows[0]}
    mean["siamese_px"] = mean.pop("siamese_px2") ** 0.5
    return Signals(**mean)


def _of_batch(net: TrackNet, batch: Moments, params: SignalParams, generator: torch.Generator) -> dict[str, Tensor]:
    frames = batch.frames.flatten(0, 1)
    found = net.places(distribution(masked(net.detector(frames), batch.ignored)))
    shares = net.shares(found.mass)
    tracks, weights = net.tracks(found, len(batch.frames))
    noisy = tracks + params.noise_px * torch.randn(tracks.shape, generator=generator).to(tracks)
    hidden = None if batch.ignored is None else batch.ignored.flatten(0, 1)
    extents = (tracks - tracks.mean(1, keepdim=True)).square().sum(-1).mean(1).sqrt()
    return {
        "order_nats": causality(net.judge, noisy, weights, 8, generator),
        "order_accuracy": _accuracy(net, noisy, weights, generator),
        "siamese_px2": (shares * net.turning_errors(frames, found.xy, hidden, 1, False)).sum(),
        "entropy_nats": (shares * found.spread).sum(),
        "motion_share": _motion_share(batch, found.xy, shares > 0, net.detector.stride, params.near_px),
        "extent_px": extents[weights > 0].median() if (weights > 0).any() else torch.zeros(()),
    }


def _accuracy(net: TrackNet, xy: Tensor, weights: Tensor, generator: torch.Generator) -> Tensor:
    unnatural = (net.judge(shuffled(xy, 8, generator)) < 0).float().mean(1)
    return 0.5 * (weights * ((net.judge(xy) > 0).float() + unnatural)).sum()


def _motion_share(batch: Moments, xy: Tensor, held: Tensor, stride: int, near_px: float) -> Tensor:
    """Share of the motion near any of the places (B, K, 2) that are `held` (B, K)."""
    motion = batch.motion(stride)
    xs, ys = (cell_centres(count, stride).to(xy) for count in (motion.shape[2], motion.shape[1]))
    across, down = (xs - xy[..., :1]).square(), (ys - xy[..., 1:]).square()
    near = (across[..., None, :] + down[..., :, None] <= near_px**2) & held[..., None, None]
    return (motion * near.any(1)).flatten(1).sum(1).mean()
