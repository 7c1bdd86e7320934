"""What tracker and predictor learn from together: stretches of film, and frames of them in which both are to agree."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from physpipe.predictor_learning.arrays import as_input
from physpipe.predictor_learning.windows import TrackWindows
from physpipe.predictors.base import Window
from physpipe.tracknet.moments import Moments


@dataclass(frozen=True)
class Stretch:
    """B stretches of film, the same frames of each."""

    window: Window
    """Its positions are those of the unsupervised tracks."""
    looks: Tensor
    """(A,) numbers of the frames that are looked at among those asked for, 0 being the first after the seen ones."""
    frames: Tensor
    """(B, A, 3, H, W) those frames, RGB in [0, 1]."""

    @property
    def times(self) -> Tensor:
        """(B, A) frames since the first one seen."""
        return self.window.asked_times[:, self.looks]

    @property
    def xy(self) -> Tensor:
        """(B, A, K, 2) where the tracks are in those frames, pixels."""
        return self.window.target[:, self.looks]


@dataclass(frozen=True)
class Batch:
    """One step of learning together."""

    moments: Moments
    """What the tracker goes on to learn from alone, so that it forgets nothing."""
    window: Window
    """What the predictor goes on to learn from alone."""
    stretch: Stretch
    """What they learn from each other."""


def cut(windows: TrackWindows, numbers: Sequence[int], looks: Sequence[int]) -> Stretch:
    """The windows of those numbers, to be looked at in the frames `looks` after the seen ones."""
    at = [windows.seen_frames + each for each in looks]
    frames = as_input(np.stack([windows.film(number, at) for number in numbers]))
    return Stretch(windows.batch(numbers), torch.tensor(looks), frames)


def draw(windows: TrackWindows, count: int, looks: int, generator: torch.Generator) -> Stretch:
    """`count` random stretches and `looks` random frames to look at, the same of each."""
    numbers = windows.pick(count, 0.0, generator)
    chosen = torch.randperm(_ahead(windows), generator=generator)[:looks].sort().values
    return cut(windows, numbers, chosen.tolist())


def evenly(windows: TrackWindows, count: int, looks: int, together: int) -> list[Stretch]:
    """At most `count` stretches, `together` at a time, looked at in `looks` frames that end with the last."""
    chosen = np.unique(np.linspace(0, _ahead(windows) - 1, looks + 1).round().astype(int)[1:]).tolist()
    numbers = windows.evenly(count).tolist()
    return [cut(windows, numbers[at : at + together], chosen) for at in range(0, len(numbers), together)]


def _ahead(windows: TrackWindows) -> int:
    """How many frames follow the seen ones."""
    return windows.horizon + 1 - windows.seen_frames
