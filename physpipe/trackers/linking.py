"""Detections of every frame to tracks: who is who by motion, births and deaths, doubts owned up to (ours)."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.optimize import linear_sum_assignment

from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory

Floats = NDArray[np.floating]


class LinkParams(Section):
    """How detections of neighbouring frames are taken for the same object."""

    gate_px: float = Field(gt=0)
    """Largest distance of a detection from where its track was going."""
    memory_frames: int = Field(ge=0)
    """Frames that a track outlives unseen; when it is seen again they are filled by a straight line."""
    least_share: float = Field(ge=0, le=1)
    """Share of a clip's frames in which an object must be seen; what shows more briefly is dropped."""
    doubt_px: float = Field(ge=0)
    """Two tracks that would cost less than this more when exchanged are ambiguous there."""


@dataclass
class _Track:
    """One object while the frames go by."""

    frames: list[int]
    xy: list[Floats]
    score: list[float]
    doubts: set[int] = field(default_factory=set)

    def expected(self, frame: int) -> Floats:
        """(2,) where it is at `frame` if it goes on as it went."""
        if len(self.xy) < 2:
            return self.xy[-1]
        velocity = (self.xy[-1] - self.xy[-2]) / (self.frames[-1] - self.frames[-2])
        return self.xy[-1] + velocity * (frame - self.frames[-1])

    def add(self, frame: int, xy: Floats, score: float) -> None:
        self.frames.append(frame)
        self.xy.append(xy)
        self.score.append(score)

    def trajectory(self, length: int) -> Trajectory:
        """Over all frames of the clip: NaN before birth and after death, straight lines over what was unseen."""
        within = np.arange(self.frames[0], self.frames[-1] + 1)
        xy, score = np.full((length, 2), np.nan, np.float32), np.zeros(length, np.float32)
        xy[within] = np.stack([np.interp(within, self.frames, axis) for axis in np.transpose(self.xy)], axis=1)
        score[self.frames] = self.score
        return Trajectory(xy, score, np.isin(np.arange(length), sorted(self.doubts)))


def link(places: Sequence[Floats], scores: Sequence[Floats], params: LinkParams) -> list[Trajectory]:
    """Tracks of a clip from the (n_t, 2) places and (n_t,) scores found in each of its frames, the surest first."""
    living: list[_Track] = []
    ended: list[_Track] = []
    for frame, (xy, score) in enumerate(zip(places, scores, strict=True)):
        ended += [track for track in living if frame - track.frames[-1] > params.memory_frames + 1]
        living = [track for track in living if frame - track.frames[-1] <= params.memory_frames + 1]
        pairs = _assigned(living, xy, frame, params)
        for track, number in pairs:
            track.add(frame, xy[number], float(score[number]))
        taken = {number for _, number in pairs}
        living += [_Track([frame], [xy[n]], [float(score[n])]) for n in range(len(xy)) if n not in taken]
    kept = [each for each in ended + living if len(each.frames) >= params.least_share * len(places)]
    kept.sort(key=lambda track: (-sum(track.score), track.frames[0]))
    return [track.trajectory(len(places)) for track in kept]


def _assigned(living: list[_Track], xy: Floats, frame: int, params: LinkParams) -> list[tuple[_Track, int]]:
    """Tracks and the numbers of their detections; notes on the tracks where an exchange would cost little more."""
    if not living or not len(xy):
        return []
    expected = np.stack([track.expected(frame) for track in living])
    cost = np.linalg.norm(expected[:, None] - xy, axis=-1)
    # Far beyond the gate all pairs are alike, so that one of them cannot drive a good pair apart.
    rows, columns = linear_sum_assignment(np.minimum(cost, 4 * params.gate_px))
    pairs = [(row, column) for row, column in zip(rows, columns, strict=True) if cost[row, column] <= params.gate_px]
    for row, column in pairs:
        _doubt(living[row], [living[other] for other in range(len(living)) if other != row], xy[column], frame, params)
    for at, (row, column) in enumerate(pairs):
        for other_row, other_column in pairs[:at]:
            exchanged = cost[row, other_column] + cost[other_row, column]
            if exchanged - cost[row, column] - cost[other_row, other_column] < params.doubt_px:
                living[row].doubts.add(frame)
                living[other_row].doubts.add(frame)
    return [(living[row], int(column)) for row, column in pairs]


def _doubt(track: _Track, others: list[_Track], xy: Floats, frame: int, params: LinkParams) -> None:
    """A track seen again near where another one was, too, may be that other one."""
    unseen = range(track.frames[-1] + 1, frame + 1)
    if len(unseen) < 2:
        return
    for other in others:
        if np.linalg.norm(other.expected(frame) - xy) <= params.gate_px:
            track.doubts.update(unseen)
            other.doubts.update(unseen)
