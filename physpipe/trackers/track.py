"""One object while the frames of a clip go by."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from physpipe.trackers.base import Trajectory

Floats = NDArray[np.floating]


@dataclass
class Track:
    """Where it was so far, and how that is known."""

    frames: list[int]
    xy: list[Floats]
    """(2,) pixels at each of `frames`."""
    score: list[float]
    """Share of the heat map where it was detected, else how well its look fits."""
    detected: list[int]
    """Frames of a detection; in the others the track was sought by its look."""
    doubts: set[int] = field(default_factory=set)

    def lives(self, frame: int, memory_frames: int) -> bool:
        """Whether it may still be seen at `frame`."""
        return frame - self.detected[-1] <= min(memory_frames, len(self.detected)) + 1

    def expected(self, frame: int, speed_frames: int) -> Floats:
        """(2,) where it is at `frame` if it goes on as it went in the last `speed_frames`."""
        first = max(-speed_frames - 1, -len(self.xy))
        ago = self.frames[-1] - self.frames[first]
        speed = (self.xy[-1] - self.xy[first]) / ago if ago else np.zeros(2)
        return self.xy[-1] + speed * (frame - self.frames[-1])

    def add(self, frame: int, xy: Floats, score: float, detected: bool = True) -> None:
        """Goes on to `xy` (2,)."""
        self.frames.append(frame)
        self.xy.append(xy)
        self.score.append(score)
        if detected:
            self.detected.append(frame)

    def sureness(self) -> float:
        """Sum of the heat map's shares; the fit of a look is none, for a mark on the ground fits best of all."""
        detected = set(self.detected)
        return sum(score for frame, score in zip(self.frames, self.score, strict=True) if frame in detected)

    def go_on_as(self, other: "Track") -> None:
        """Takes over all that `other` has, which proved to be the same object and is empty afterwards."""
        before = [at for at, frame in enumerate(self.frames) if frame < other.frames[0]]
        self.doubts |= other.doubts | set(range(self.detected[-1] + 1, other.frames[0] + 1))
        self.frames = [self.frames[at] for at in before] + other.frames
        self.xy = [self.xy[at] for at in before] + other.xy
        self.score = [self.score[at] for at in before] + other.score
        self.detected += other.detected
        other.frames, other.xy, other.score, other.detected = [], [], [], []

    def trajectory(self, length: int, still_px: float) -> Trajectory:
        """Over all frames of the clip, straight lines over gaps: NaN before the first detection and after the last
        place."""
        within = np.arange(self.frames[0], self.frames[-1] + 1)
        xy, score = np.full((length, 2), np.nan, np.float32), np.zeros(length, np.float32)
        xy[within] = np.stack([np.interp(within, self.frames, axis) for axis in np.transpose(self.xy)], axis=1)
        score[self.frames] = self.score
        still = bool(np.stack(self.xy).var(axis=0).sum() < still_px**2)
        return Trajectory(xy, score, np.isin(np.arange(length), sorted(self.doubts)), still)
