"""The unsupervised tracker while it learns: detector, discriminator and the schedule that makes them lock."""

import math
from dataclasses import dataclass

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.tracknet.detector import Detector, DetectorParams
from physpipe.tracknet.discriminator import Discriminator, DiscriminatorParams
from physpipe.tracknet.heatmap import distribution, entropy, expected_position
from physpipe.tracknet.losses import (
    causality,
    causality_by_coin,
    motion_cross_entropy,
    motion_target,
    turned,
    turned_back,
)

COIN_NATS = math.log(2)
"""Loss of a discriminator that cannot tell."""


class LossParams(Section):
    """Weights of the paper's losses (section 3.1: 1, 0.01, 0.001)."""

    causality: float = Field(ge=0)
    """Weight of L_disc (nats)."""
    entropy: float = Field(ge=0)
    """Weight of L_ent (nats)."""
    equivariance: float = Field(ge=0)
    """Weight of L_siam (squared pixels)."""


class BottleneckParams(Section):
    """Noise on the positions that the discriminator sees; flat heat maps cannot carry a signal through it (ours)."""

    start_px: float = Field(ge=0)
    """Standard deviation at the first step."""
    end_px: float = Field(ge=0)
    """Largest standard deviation; 0 switches the noise off and every loss to its full weight at once."""
    growth: float = Field(gt=1)
    """Factor a step while the discriminator wins; its inverse while it loses."""
    winning: float = Field(gt=0)
    """Running L_disc in nats below which the discriminator wins (a coin has 0.693)."""


class TrackNetParams(Section):
    """One recipe for learning a detector."""

    detector: DetectorParams
    discriminator: DiscriminatorParams
    losses: LossParams
    bottleneck: BottleneckParams
    negatives: int = Field(ge=0)
    """Shuffles scored beside each natural order; 0 = the paper's coin."""
    turned_share: float = Field(gt=0, le=1)
    """Share of the frames that also go through the Siamese branch."""
    mirrored: bool
    """Whether the Siamese branch also mirrors (the paper only turns by +-90 degrees)."""
    flicker: float = Field(ge=0, lt=1)
    """Largest random gain of single frames, so that brightness tells no order; 0 = none (paper)."""
    warm_start_steps: int = Field(ge=0)
    """First steps, in which the heat map is fitted to the motion residual; 0 = none (paper)."""


@dataclass(frozen=True)
class Moments:
    """A training batch."""

    frames: Tensor
    """(B, 5, 3, H, W) in [0, 1], five moments of one film in their natural order."""
    background: Tensor
    """(B, 3, H, W) temporal median of each film."""
    ignored: Tensor | None = None
    """(B, 5, h, w) heat-map cells where nothing may be found (sequential masking), or None."""

    def motion(self, stride: int) -> Tensor:
        """(B * 5, h, w) share of each frame's motion residual in each cell, ignored ones included."""
        background = self.background.repeat_interleave(self.frames.shape[1], 0)
        return motion_target(self.frames.flatten(0, 1), background, stride)

    def outside_mask(self, cells: Tensor) -> Tensor:
        """(B * 5, h, w) `cells`, 0 where ignored."""
        return cells if self.ignored is None else cells * ~self.ignored.flatten(0, 1)


class TrackNet(nn.Module):
    """Detector and discriminator with their losses; what is learned without labels."""

    sigma: Tensor
    running: Tensor
    steps: Tensor

    def __init__(self, params: TrackNetParams, frame_size: float):
        super().__init__()
        self.params = params
        self.detector = Detector(params.detector)
        self.judge = Discriminator(params.discriminator, frame_size)
        self.register_buffer("sigma", torch.tensor(params.bottleneck.start_px))
        self.register_buffer("running", torch.tensor(COIN_NATS))
        self.register_buffer("steps", torch.tensor(0))

    def restart(self) -> None:
        """Sets the schedule back to the first step; the weights stay."""
        self.steps.zero_()
        self.sigma.fill_(self.params.bottleneck.start_px)
        self.running.fill_(COIN_NATS)

    def loss(self, batch: Moments, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """The warm start's loss in the first steps, the paper's three afterwards."""
        self.steps += 1
        frames = batch.frames.flatten(0, 1)
        if self.params.flicker:
            gain = torch.rand(len(frames), 1, 1, 1, generator=generator).to(frames) * 2 - 1
            frames = frames * (1 + self.params.flicker * gain)
        logits = masked(self.detector(frames), batch.ignored)
        if self.steps <= self.params.warm_start_steps:
            return self._warm_start(batch, logits)
        return self._paper(batch, frames, logits, generator)

    def _warm_start(self, batch: Moments, logits: Tensor) -> tuple[Tensor, dict[str, float]]:
        target = batch.outside_mask(batch.motion(self.detector.stride))
        loss = motion_cross_entropy(logits, target)
        return loss, {"motion_nats": loss.item()}

    def _paper(
        self, batch: Moments, frames: Tensor, logits: Tensor, generator: torch.Generator
    ) -> tuple[Tensor, dict[str, float]]:
        heat = distribution(logits)
        xy = expected_position(heat, self.detector.stride)
        order = self._order_loss(xy.unflatten(0, batch.frames.shape[:2]), generator)
        spread = entropy(heat).mean()
        siamese = self._equivariance(frames, xy, batch.ignored, generator)
        self._adapt(order.item())
        weights, ramp = self.params.losses, self.ramp()
        loss = weights.causality * order + ramp * (weights.entropy * spread + weights.equivariance * siamese)
        parts = {"order_nats": order, "entropy_nats": spread, "siamese_px2": siamese, "sigma_px": self.sigma}
        return loss, {name: value.item() for name, value in parts.items()}

    def _order_loss(self, xy: Tensor, generator: torch.Generator) -> Tensor:
        if self.params.bottleneck.end_px:
            xy = xy + self.sigma * torch.randn(xy.shape, generator=generator).to(xy)
        if self.params.negatives == 0:
            return causality_by_coin(self.judge, xy, generator)
        return causality(self.judge, xy, self.params.negatives, generator)

    def _equivariance(self, frames: Tensor, xy: Tensor, ignored: Tensor | None, generator: torch.Generator) -> Tensor:
        chosen = torch.randperm(len(frames), generator=generator)[: max(1, int(self.params.turned_share * len(frames)))]
        turns = (1, 3)[int(torch.randint(2, (), generator=generator))]
        mirrored = self.params.mirrored and bool(torch.randint(2, (), generator=generator))
        other = None if ignored is None else turned(ignored.flatten(0, 1)[chosen][:, None], turns, mirrored)
        logits = masked(self.detector(turned(frames[chosen], turns, mirrored)), other)
        seen = expected_position(distribution(logits), self.detector.stride)
        back = turned_back(seen, turns, mirrored, *frames.shape[-2:])
        return (back - xy[chosen]).square().sum(1).mean()

    def ramp(self) -> Tensor:
        """How much of the sharpening losses' weight is on: nothing sharpens before the order can be told."""
        end = self.params.bottleneck.end_px
        return self.sigma / end if end else torch.ones_like(self.sigma)

    def _adapt(self, order: float) -> None:
        bottleneck = self.params.bottleneck
        self.running.lerp_(torch.tensor(order).to(self.running), 0.05)
        if bottleneck.end_px:
            wins = bool(self.running < bottleneck.winning)
            self.sigma.mul_(bottleneck.growth if wins else 1 / bottleneck.growth)
            self.sigma.clamp_(bottleneck.start_px, bottleneck.end_px)


def masked(logits: Tensor, ignored: Tensor | None) -> Tensor:
    """Scores shifted to be positive, then zero where `ignored`, as the paper does before the softmax (section 3.1).

    A softmax gives exp(0 - bias) at those cells: with a bias of 100 above the lowest score, nothing.
    """
    if ignored is None:
        return logits
    lowest = logits.flatten(1).min(1).values[:, None, None]
    return torch.where(ignored.view(logits.shape), torch.zeros_like(logits), logits - lowest + 100.0)
