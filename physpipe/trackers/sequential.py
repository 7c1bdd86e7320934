"""Sequential masking: each detector is blind to what the earlier ones found (paper section 3.1)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory
from physpipe.trackers.learned import LearnedTracker


class MaskParams(Section):
    """The circle that hides an object already found."""

    radius_px: float = Field(gt=0)
    """Radius r of the circle; about an object's diameter."""


class SequentialTracker:
    """Trackers T1 ... TK, run in turn on the same frames."""

    def __init__(self, trackers: Sequence[LearnedTracker], mask: MaskParams):
        self.trackers, self.mask = trackers, mask

    def track_all(self, frames: NDArray[np.uint8]) -> list[Trajectory]:
        """K trajectories in (T, H, W, 3) frames, in the order in which the detectors were learned."""
        found: list[Trajectory] = []
        for tracker in self.trackers:
            found.append(tracker.track(frames, ignore=hidden_by(found, self.mask, frames.shape[1], frames.shape[2])))
        return found


def hidden_by(found: Sequence[Trajectory], mask: MaskParams, height: int, width: int) -> NDArray[np.bool_] | None:
    """(T, H, W) pixels in the circles around what was found so far; None when nothing was."""
    hidden = [circles(each.xy, mask.radius_px, height, width) for each in found]
    return np.logical_or.reduce(hidden) if hidden else None


def circles(xy: NDArray[np.floating], radius_px: float, height: int, width: int) -> NDArray[np.bool_]:
    """(T, H, W) pixels within `radius_px` of (T, 2) positions; none where a position is NaN."""
    across = (np.arange(width) - xy[:, :1]) ** 2
    down = (np.arange(height) - xy[:, 1:]) ** 2
    return across[:, None, :] + down[:, :, None] <= radius_px**2
