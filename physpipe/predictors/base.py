"""What every predictor of motion is given, gives back, and is judged by while it learns."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.predictors.misses import Misses


@dataclass(frozen=True)
class Seen:
    """What a predictor may know; nothing of the frames that it is asked for."""

    frames: Tensor
    """(B, S, 3, H, W) RGB in [0, 1]; S = T0, and one more, the last, for a predictor that sees the end."""
    xy: Tensor
    """(B, T0, K, 2) pixels; where the objects are at the end is not given."""
    times: Tensor
    """(B, S) frames since the first one seen."""
    steady: bool = False
    """Whether the camera's motion is taken off `xy` already: all are as in the last of those frames."""


@dataclass(frozen=True)
class Forecast:
    """Where the objects will be."""

    mean: Tensor
    """(B, N, K, 2) pixels."""
    cov: Tensor | None = None
    """(B, N, K, 2, 2) square pixels; None where nothing is known of how sure it is."""


@dataclass(frozen=True)
class Window:
    """Stretches of film with the answer, to learn from."""

    seen: Seen
    asked_times: Tensor
    """(B, N) frames since the first one seen."""
    target: Tensor
    """(B, N, K, 2) pixels."""
    frames_per_s: float
    """Rate of the film."""
    track: Tensor
    """(B, L, K, 2) pixels, where the objects are in all of the clip; NaN where one is lost, and after its end."""


class Predictor(nn.Module, ABC):
    """Forecasts positions from the first frames and positions of a stretch of film."""

    Params: ClassVar[type[Section]]
    """What configures it."""
    seen_frames: ClassVar[int]
    """Consecutive frames that it sees, with the positions in them (T0)."""
    sees_end: ClassVar[bool] = False
    """Whether it also sees the frame, not the positions, of the last time that it may be asked for."""
    steadies: ClassVar[bool] = False
    """Whether it takes the camera's motion off what it sees, and so learns the motion of the scene alone."""
    objects_alike: bool = False
    """Whether permuting the objects permutes the forecast and changes nothing else."""

    def __init__(self, params: Section, objects: int):
        """`objects`: K, the number of objects in every clip."""
        super().__init__()
        self.objects = objects
        self.misses = Misses()

    @abstractmethod
    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        """Positions at `asked_times` (B, N) frames since the first one seen."""

    def forecast(self, seen: Seen, asked_times: Tensor) -> Forecast:
        """As `forward`, with a covariance even where that has none: as sure as it was right on held-out film."""
        made = self(seen, asked_times)
        if made.cov is not None or not self.misses.known:
            return made
        cov = self.misses(asked_times - seen.times[:, self.seen_frames - 1, None])
        return Forecast(made.mean, cov.unsqueeze(2).expand(-1, -1, self.objects, -1, -1))

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean distance from the target in pixels; its square would be ruled by the few wildest windows."""
        distance = distance_px(self(batch.seen, batch.asked_times).mean, batch.target)
        return distance.mean(), {"train_last_px": distance[:, -1].mean().item()}

    def watch(self, camera: Sequence[Tensor]) -> None:
        """Before all else is learned, of one that `steadies`: the camera's way (T, 2) px in each training clip."""

    def calibrate(self, held_out: Window) -> None:
        """Once all else is learned: fits how sure it is to stretches of film that nothing was learned from.

        One that sees the end misses least near both ends, which no power of time describes: nothing is fitted to it.
        """
        if self.sees_end:
            return
        made = self(held_out.seen, held_out.asked_times)
        if made.cov is None:
            ahead = held_out.asked_times[0] - held_out.seen.times[0, -1]
            self.misses.fit(held_out.target - made.mean, ahead)

    def validation_loss(self, batch: Window) -> Tensor:
        """What validation minimises: the mean distance from the target at the last time asked for, in pixels."""
        last = self(batch.seen, batch.asked_times[:, -1:]).mean
        return torch.linalg.vector_norm(last - batch.target[:, -1:], dim=-1).mean()


def distance_px(found: Tensor, target: Tensor) -> Tensor:
    """(...) distance of positions (..., 2) px, with a finite gradient at 0."""
    return ((found - target).square().sum(-1) + 1e-6).sqrt()
