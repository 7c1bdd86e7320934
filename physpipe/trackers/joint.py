"""All objects in one pass, their number not given: peaks of one heat map, linked over time (ours).

The paper names this as its main limitation: objects had to differ in colour and were learned one after the other.
"""

import numpy as np
import torch
from numpy.typing import NDArray

from physpipe.trackers.base import Trajectory
from physpipe.trackers.learned import LearnedTracker
from physpipe.trackers.linking import LinkParams, link
from physpipe.tracknet.places import PeakParams, around, peaks


class JointTracker:
    """One detector with several peaks; finds all that it was taught to, alike or not."""

    def __init__(self, detector: LearnedTracker, peaks_params: PeakParams, links: LinkParams):
        self.detector, self.peaks, self.links = detector, peaks_params, links

    def track_all(self, frames: NDArray[np.uint8]) -> list[Trajectory]:
        """Trajectories in (T, H, W, 3) frames, the surest first; a score is the share of the heat map."""
        places, masses = self.detect(frames)
        held = masses >= self.peaks.least_mass
        return link(
            [xy[each] for xy, each in zip(places, held, strict=True)],
            [mass[each] for mass, each in zip(masses, held, strict=True)],
            self.links,
        )

    def detect(self, frames: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(T, slots, 2) pixels and (T, slots) share of the heat map of every peak, the highest peak first."""
        stride, found = self.detector.detector.stride, []
        for heat in self.detector.heat_maps(frames):
            found.append(around(heat, stride, peaks(heat, stride, self.peaks), self.peaks.window_px))
        xy, mass = (torch.cat([getattr(each, name) for each in found]).cpu().numpy() for name in ("xy", "mass"))
        return xy, mass
