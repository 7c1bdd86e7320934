"""Detections of every frame to tracks: who is who by motion, births and deaths, doubts owned up to (ours)."""

from collections.abc import Callable, Container, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.optimize import linear_sum_assignment

from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory
from physpipe.trackers.track import Track

Floats = NDArray[np.floating]


class LinkParams(Section):
    """How detections of neighbouring frames are taken for the same object."""

    gate_px: float = Field(gt=0)
    """Largest distance of a detection from where its track was going; grows as the root of the frames since then."""
    apart_px: float = Field(ge=0)
    """Two tracks nearer than this are at the same object: only the one that was going there stays."""
    memory_frames: int = Field(ge=0)
    """Frames in a row that a track may go without a detection; never more than the detections that it has had."""
    least_share: float = Field(ge=0, le=1)
    """Share of a clip's frames in which an object must be detected; what shows more briefly is dropped."""
    doubt_px: float = Field(ge=0)
    """Two tracks that would cost less than this more when exchanged are ambiguous there."""
    search_px: int = Field(ge=1)
    """Farthest along x and y that a track without a detection of its own is sought from where it was going."""
    look_frames: int = Field(ge=1)
    """Latest detections of a track whose mean look it is sought by."""
    speed_frames: int = Field(ge=1)
    """Frames back over which a track's speed is taken."""
    still_px: float = Field(ge=0)
    """Root mean square distance from its mean place below which a track is still: more likely a mark on the ground that
    the camera's wobble moves than an object."""


Seek = Callable[[Track, int], "tuple[Floats, float] | None"]
"""Looks for a track that no detection claims: its (2,) place and score at a frame, or None."""


def link(places: Sequence[Floats], scores: Sequence[Floats], params: LinkParams, seek: Seek) -> list[Trajectory]:
    """Tracks of a clip from the (n_t, 2) places and (n_t,) scores found in each of its frames: those that move, the
    surest first, then those that are still."""
    living: list[Track] = []
    ended: list[Track] = []
    for frame, (xy, score) in enumerate(zip(places, scores, strict=True)):
        ended += [track for track in living if not track.lives(frame, params.memory_frames)]
        living = [track for track in living if track.lives(frame, params.memory_frames)]
        pairs = _assigned(living, xy, frame, params)
        born = [Track([frame], [xy[n]], [float(score[n])], [frame]) for n in range(len(xy)) if n not in pairs.values()]
        merged = _merged(living, pairs, xy, frame, params)
        pairs = {row: number for row, number in pairs.items() if row not in merged}
        for row, number in pairs.items():
            living[row].add(frame, xy[number], float(score[number]))
        _seek_others(living, {row: xy[number] for row, number in pairs.items()}, frame, params, seek)
        living = [track for track in living if track.frames]
        living += born
    shown = [each for each in ended + living if len(each.detected) >= params.least_share * len(places)]
    shown.sort(key=lambda track: (-track.sureness(), track.frames[0]))
    return sorted((track.trajectory(len(places), params.still_px) for track in shown), key=lambda each: each.still)


def _assigned(living: list[Track], xy: Floats, frame: int, params: LinkParams) -> dict[int, int]:
    """Track to detection, by number; notes on the tracks where an exchange would cost little more."""
    if not living or not len(xy):
        return {}
    expected = np.stack([track.expected(frame, params.speed_frames) for track in living])
    cost = np.linalg.norm(expected[:, None] - xy, axis=-1)
    gates = params.gate_px * np.sqrt([frame - track.frames[-1] for track in living])
    # Beyond the gate all pairs are alike, so that one of them cannot drive a good pair apart.
    assigned = zip(*linear_sum_assignment(np.minimum(cost, 4 * gates.max())), strict=True)
    pairs = {int(row): int(number) for row, number in assigned if cost[row, number] <= gates[row]}
    for row, other in combinations(pairs, 2):
        exchanged = cost[row, pairs[other]] + cost[other, pairs[row]]
        if exchanged - cost[row, pairs[row]] - cost[other, pairs[other]] < params.doubt_px:
            living[row].doubts.add(frame)
            living[other].doubts.add(frame)
    return pairs


def _seek_others(living: list[Track], taken: dict[int, Floats], frame: int, params: LinkParams, seek: Seek) -> None:
    """Moves the tracks that have no place yet to where their look is found; `taken` holds the places of the others.

    A place that is taken belongs to another object, unless that track began after this one was lost from sight.
    """
    sought = {row: seek(living[row], frame) for row in _alone(living, taken)}
    found_near = {row: found for row, found in sought.items() if found is not None}

    def surprise_px(row: int) -> float:
        return float(np.linalg.norm(living[row].expected(frame, params.speed_frames) - found_near[row][0]))

    for row in sorted(found_near, key=surprise_px):
        found = found_near[row]
        rivals = [other for other, xy in taken.items() if np.linalg.norm(found[0] - xy) < params.apart_px]
        if not rivals:
            living[row].add(frame, *found, detected=False)
            taken[row] = found[0]
        for other in rivals:
            if living[other].frames and living[other].frames[0] > living[row].detected[-1]:
                living[row].go_on_as(living[other])
                taken[row] = taken.pop(other)
                break


def _alone(living: list[Track], placed: Container[int]) -> list[int]:
    """Tracks that have no place yet."""
    return [row for row in range(len(living)) if row not in placed]


def _merged(living: list[Track], pairs: dict[int, int], xy: Floats, frame: int, params: LinkParams) -> set[int]:
    """Tracks whose detection may be that of a neighbour, too: two objects that touch look like one. Both are
    ambiguous."""
    merged = set()
    for row, number in pairs.items():
        for other in _alone(living, pairs):
            if np.linalg.norm(living[other].expected(frame, params.speed_frames) - xy[number]) <= params.gate_px:
                merged.add(row)
                living[row].doubts.add(frame)
                living[other].doubts.add(frame)
    return merged
