"""The unsupervised tracker while it learns: detector, discriminator and the schedule that makes them lock."""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.tracknet.bottleneck import Bottleneck, BottleneckParams
from physpipe.tracknet.detector import Detector, DetectorParams
from physpipe.tracknet.discriminator import Discriminator, DiscriminatorParams
from physpipe.tracknet.heatmap import distribution
from physpipe.tracknet.losses import causality, causality_by_coin, motion_cross_entropy
from physpipe.tracknet.moments import Moments, masked
from physpipe.tracknet.places import PeakParams, Places, around, linked, peaks, taken, whole
from physpipe.tracknet.turns import turned, turned_along, turned_back


class LossParams(Section):
    """Weights of the paper's losses (section 3.1: 1, 0.01, 0.001), and of ours."""

    causality: float = Field(ge=0)
    """Weight of L_disc (nats)."""
    entropy: float = Field(ge=0)
    """Weight of L_ent (nats)."""
    equivariance: float = Field(ge=0)
    """Weight of L_siam (squared pixels)."""
    motion: float = Field(ge=0)
    """Weight of the heat map's cross-entropy with the motion residual after the warm start, nats; 0 = none (paper)."""


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
    peaks: PeakParams | None
    """How several objects are found at once; empty = one object, the mean of the whole heat map (paper)."""


class TrackNet(nn.Module):
    """Detector and discriminator with their losses; what is learned without labels."""

    steps: Tensor

    def __init__(self, params: TrackNetParams, frame_size: float):
        super().__init__()
        self.params = params
        self.detector = Detector(params.detector)
        self.judge = Discriminator(params.discriminator, frame_size)
        self.bottleneck = Bottleneck(params.bottleneck)
        self.register_buffer("steps", torch.tensor(0))

    def restart(self) -> None:
        """Sets the schedule back to the first step; the weights stay."""
        self.steps.zero_()
        self.bottleneck.restart()

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
        loss = self._motion(batch, logits)
        return loss, {"motion_nats": loss.item()}

    def _motion(self, batch: Moments, logits: Tensor) -> Tensor:
        several, stride = self.params.peaks, self.detector.stride
        target = (
            batch.motion(stride) if several is None else batch.even_motion(stride, several.even, several.nearby_cells)
        )
        return motion_cross_entropy(logits, batch.outside_mask(target))

    def _paper(
        self, batch: Moments, frames: Tensor, logits: Tensor, generator: torch.Generator
    ) -> tuple[Tensor, dict[str, float]]:
        found = self.places(distribution(logits))
        tracks, weights = self.tracks(found, len(batch.frames))
        order = self._order_loss(tracks, weights, generator)
        shares = self.shares(found.mass)
        spread = (shares * found.spread).sum()
        siamese = self._equivariance(frames, found, batch.ignored, generator)
        self.bottleneck.adapt(order.item())
        weigh, ramp = self.params.losses, self.bottleneck.ramp()
        loss = weigh.causality * order + ramp * (weigh.entropy * spread + weigh.equivariance * siamese)
        parts = {"order_nats": order, "entropy_nats": spread, "siamese_px2": siamese, "sigma_px": self.bottleneck.sigma}
        if weigh.motion:
            parts["motion_nats"] = self._motion(batch, logits)
            loss = loss + weigh.motion * parts["motion_nats"]
        return loss, {name: value.item() for name, value in parts.items()}

    def places(self, heat: Tensor, centres: Tensor | None = None) -> Places:
        """Where objects are in (B, h, w); at the heat map's own peaks unless (B, K, 2) `centres` are given."""
        params, stride = self.params.peaks, self.detector.stride
        if params is None:
            return whole(heat, stride)
        return around(heat, stride, peaks(heat, stride, params) if centres is None else centres, params.window_px)

    def shares(self, mass: Tensor) -> Tensor:
        """Weights that sum to 1 of places or tracks of (B, K) `mass`: 0 where it is too little for an object."""
        least = 0.0 if self.params.peaks is None else self.params.peaks.least_mass
        kept = torch.where(mass >= least, mass, 0).detach()
        return kept / kept.sum().clamp_min(1e-6)

    def tracks(self, found: Places, films: int) -> tuple[Tensor, Tensor]:
        """(N, 5, 2) positions of the same object through the moments of each film, and their (N,) weights."""
        xy, mass = (each.unflatten(0, (films, -1)) for each in (found.xy, found.mass))
        order = linked(xy.detach())
        weights = self.shares(mass.gather(2, order).min(1).values)
        return taken(xy, order).transpose(1, 2).flatten(0, 1), weights.flatten()

    def _order_loss(self, xy: Tensor, weights: Tensor, generator: torch.Generator) -> Tensor:
        xy = self.bottleneck(xy, generator)
        if self.params.negatives == 0:
            return causality_by_coin(self.judge, xy, weights, generator)
        return causality(self.judge, xy, weights, self.params.negatives, generator)

    def _equivariance(
        self, frames: Tensor, found: Places, ignored: Tensor | None, generator: torch.Generator
    ) -> Tensor:
        chosen = torch.randperm(len(frames), generator=generator)[: max(1, int(self.params.turned_share * len(frames)))]
        turns = (1, 3)[int(torch.randint(2, (), generator=generator))]
        mirrored = self.params.mirrored and bool(torch.randint(2, (), generator=generator))
        hidden = None if ignored is None else ignored.flatten(0, 1)[chosen]
        errors = self.turning_errors(frames[chosen], found.xy[chosen], hidden, turns, mirrored)
        return (self.shares(found.mass[chosen]) * errors).sum()

    def turning_errors(self, frames: Tensor, xy: Tensor, ignored: Tensor | None, turns: int, mirrored: bool) -> Tensor:
        """(B, K) squared px between `xy` (B, K, 2) in the frames and what is found there in the turned frames."""
        H, W = frames.shape[-2:]
        hidden = None if ignored is None else turned(ignored[:, None], turns, mirrored)
        heat = distribution(masked(self.detector(turned(frames, turns, mirrored)), hidden))
        seen = self.places(heat, turned_along(xy.detach(), turns, mirrored, H, W)).xy
        return (turned_back(seen, turns, mirrored, H, W) - xy).square().sum(-1)
