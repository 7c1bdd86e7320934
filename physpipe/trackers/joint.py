"""All objects in one pass, their number not given: peaks of one heat map, linked over time (ours).

The paper names this as its main limitation: objects had to differ in colour and were learned one after the other.
"""

from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray

from physpipe.trackers.base import Trajectory
from physpipe.trackers.learned import LearnedTracker
from physpipe.trackers.linking import LinkParams, Track, link
from physpipe.trackers.refinement import RefineParams, Searcher
from physpipe.tracknet.places import PeakParams, around, peaks

LOOK_FRAMES = 20
"""Latest detections of a track whose mean look it is sought by."""


class PeakTracker:
    """One detector with several peaks; finds all that it was taught to, alike or not."""

    def __init__(
        self, detector: LearnedTracker, several: PeakParams, links: LinkParams, refinement: RefineParams | None
    ):
        self.detector, self.peaks, self.links, self.refinement = detector, several, links, refinement

    def track_all(
        self, frames: NDArray[np.uint8], objects: int | None = None, ignore: NDArray[np.bool_] | None = None
    ) -> list[Trajectory]:
        """The surest `objects` trajectories in (T, H, W, 3) frames, or as many as there are, the surest first.

        A score is the share of the heat map; `ignore` (T, H, W) marks pixels where nothing may be found.
        """
        places, masses = self.detect(frames, ignore)
        held = masses >= self.peaks.least_mass
        xy = [each[kept] for each, kept in zip(places, held, strict=True)]
        mass = [each[kept] for each, kept in zip(masses, held, strict=True)]
        return link(xy, mass, self.links, partial(self._seek, frames))[:objects]

    def _seek(self, frames: NDArray[np.uint8], track: Track, frame: int) -> tuple[NDArray[np.floating], float] | None:
        """Where a track that no detection claims is by its look; None without refinement, which knows looks."""
        if self.refinement is None:
            return None
        known = np.isin(track.frames, track.detected[-LOOK_FRAMES:])
        seen, xy = np.array(track.frames)[known], np.stack(track.xy)[known]
        searcher = Searcher(frames[seen], xy, self.refinement)
        return searcher.near(frames[frame], track.expected(frame), self.links.search_px)

    def detect(
        self, frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(T, slots, 2) pixels and (T, slots) share of the heat map of every peak, the highest peak first."""
        stride, found = self.detector.detector.stride, []
        for heat in self.detector.heat_maps(frames, ignore):
            found.append(around(heat, stride, peaks(heat, stride, self.peaks), self.peaks.window_px))
        xy, mass = (torch.cat([getattr(each, name) for each in found]).cpu().numpy() for name in ("xy", "mass"))
        return xy, mass
