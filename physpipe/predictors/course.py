"""What the tracks of whole clips teach a law of motion: how velocities change along them, and where they lead (ours).

The ground of a clip is looked at once, which takes longest, and all that its track tells of the ground is learned from.
"""

from dataclasses import dataclass
from typing import Self

import torch
from torch import Tensor

from physpipe.predictors.base import distance_px
from physpipe.predictors.kinematics import smoothed
from physpipe.predictors.terrain_law import Law, Motion, Scene


@dataclass(frozen=True)
class Course:
    """The motion along tracks, smoothed over a few frames around each of N moments; lengths in `FrameUnit`'s unit."""

    place: Tensor
    """(B, N, K, 2) smoothed, 0 where not known, as the next two are."""
    velocity: Tensor
    """(B, N, K, 2) displacement that led there."""
    turn: Tensor
    """(B, N, K, 2) change of the displacement in the next frame."""
    free: Tensor
    """(B, N) 1 where all of them are known and none can have run into anything: smoothing smears what happens in one
    frame over all frames around."""

    @classmethod
    def of(cls, track: Tensor, frames: int, law: Law, scene: Scene) -> Self:
        """Smoothed over `frames` frames."""
        motion = smoothed(track, frames)
        width = track.shape[1] - motion[0].shape[1] + 1
        known = motion[0].isfinite().all(-1).all(-1)
        free = law.untouched(scene, track, width).squeeze(-1) * known
        place, velocity, turn = (each.nan_to_num() for each in motion)
        return cls(place, velocity, turn, free)

    def mismatch(self, law: Law, scene: Scene, px: Tensor) -> Tensor:
        """() mean distance of the law's changes of velocity from those of the tracks; pixels a frame squared."""
        found = law(scene, Motion.rolling(self.place, self.velocity)).velocity - self.velocity
        off = distance_px(px * found, px * self.turn).mean(2)
        return (self.free * off).sum() / self.free.sum().clamp_min(1)


def stretches(track: Tensor, frames: int, count: int, generator: torch.Generator) -> Tensor:
    """(B, count, frames, K, 2) random stretches of each of `track` (B, L, K, 2), all places in them known.

    Each track must hold one.
    """
    every = track.unfold(1, frames, 1).movedim(-1, 2)  # (B, N, frames, K, 2)
    known = every.isfinite().flatten(2).all(2)
    drawn = torch.multinomial(known.float().cpu(), count, replacement=True, generator=generator).to(track.device)
    return every[torch.arange(len(track), device=track.device)[:, None], drawn]
