"""All objects in one pass, their number not given: peaks of one heat map, linked over time (ours).

The paper names this as its main limitation: objects had to differ in colour and were learned one after the other.
"""

import numpy as np
import torch
from numpy.typing import NDArray

from physpipe.trackers.base import Trajectory
from physpipe.trackers.learned import LearnedTracker
from physpipe.trackers.linking import LinkParams, link
from physpipe.trackers.look import RefineParams
from physpipe.trackers.refinement import Searcher
from physpipe.trackers.track import Track
from physpipe.tracknet.places import PeakParams, around, peaks


class Seeker:
    """Looks for tracks that no detection claims by the look that they had in a clip."""

    def __init__(self, frames: NDArray[np.uint8], refinement: RefineParams, links: LinkParams):
        self.frames, self.refinement, self.links = frames, refinement, links
        self.known: dict[tuple[int, ...], tuple[Track, Searcher]] = {}

    def __call__(self, track: Track, frame: int) -> tuple[NDArray[np.floating], float] | None:
        """The track's (2,) place at `frame` and how well it fits; None where nothing does."""
        expected = track.expected(frame, self.links.speed_frames)
        return self._searcher(track).near(self.frames[frame], expected, self.links.search_px)

    def _searcher(self, track: Track) -> Searcher:
        """Made once for all frames in which the track goes undetected."""
        latest = tuple(track.detected[-self.links.look_frames :])
        key = (id(track), *latest)
        if key not in self.known:  # holds the track, too, so that no other takes its id
            places = dict(zip(track.frames, track.xy, strict=True))
            xy = np.stack([places[frame] for frame in latest])
            self.known[key] = track, Searcher(self.frames[list(latest)], xy, self.refinement)
        return self.known[key][1]


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

        A score is the share of the heat map; `ignore` (T, H, W) marks pixels where nothing may be found. Every clip
        holds something that moves, for ingest keeps nothing else: where no track can be made, the highest peak of each
        frame stands in, ambiguous throughout.
        """
        places, masses = self.detect(frames, ignore)
        held = masses >= self.peaks.least_mass
        xy = [each[kept] for each, kept in zip(places, held, strict=True)]
        mass = [each[kept] for each, kept in zip(masses, held, strict=True)]
        seek = (lambda track, frame: None) if self.refinement is None else Seeker(frames, self.refinement, self.links)
        found = link(xy, mass, self.links, seek)
        return (found or [Trajectory(places[:, 0], masses[:, 0], np.ones(len(frames), bool))])[:objects]

    def detect(
        self, frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(T, slots, 2) pixels and (T, slots) share of the heat map of every peak, the highest peak first."""
        stride, found = self.detector.detector.stride, []
        for heat in self.detector.heat_maps(frames, ignore):
            found.append(around(heat, stride, peaks(heat, stride, self.peaks), self.peaks.window_px))
        xy, mass = (torch.cat([getattr(each, name) for each in found]).cpu().numpy() for name in ("xy", "mass"))
        return xy, mass
