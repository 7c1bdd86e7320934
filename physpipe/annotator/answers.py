"""Where the objects are without corrections: what `ground_truth` starts from, worked out for a clip when asked for."""

from functools import lru_cache
from threading import Lock

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.baselines.template import TemplateParams, TemplateTracker
from physpipe.io.annotations import Annotations, Box
from physpipe.io.clips import ClipSet
from physpipe.trackers.base import Trajectory

KEPT = 200
"""Trajectories remembered; one is small, and takes a second or so to find."""


class Answers:
    """The template tracker's trajectories, or else the reference positions, of one data set's clips."""

    def __init__(self, clips: ClipSet, params: TemplateParams):
        self.clips, self.params = clips, params
        self._remembered = lru_cache(KEPT)(self._track)
        self._tracking = Lock()

    def of(self, clip: str, given: Annotations) -> dict[int, Trajectory]:
        """Object to its trajectory, for every object of the clip that has a box or a reference position."""
        if referenced(clip, given):
            return self._from_reference(clip, given)
        numbers = sorted(set(given.templates.loc[given.templates["clip"] == clip, "object"]))
        with self._tracking:  # one at a time: a tracker takes a whole core
            return {int(k): self._remembered(clip, tuple(given.boxes(clip, k))) for k in numbers}

    def _track(self, clip: str, boxes: tuple[Box, ...]) -> Trajectory:
        return TemplateTracker(self.params, boxes).track(self.clips.frames(clip))

    def _from_reference(self, clip: str, given: Annotations) -> dict[int, Trajectory]:
        mine = given.reference[given.reference["clip"] == clip]
        return {int(k): _trajectory(rows, len(self.clips.rows(clip))) for k, rows in mine.groupby("object")}


def referenced(clip: str, given: Annotations) -> bool:
    """Whether the clip has reference positions; `ground_truth` then looks at no template box of it."""
    return bool((given.reference["clip"] == clip).any())


def _trajectory(rows: pd.DataFrame, T: int) -> Trajectory:
    xy: NDArray[np.float32] = np.full((T, 2), np.nan, np.float32)
    xy[rows["frame"]] = rows[["x", "y"]]
    return Trajectory(xy, np.isfinite(xy[:, 0]).astype(np.float32))
