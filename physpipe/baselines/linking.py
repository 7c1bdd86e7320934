"""Things found frame by frame become tracks: the least total distance from where each object was."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from physpipe.baselines.blobs import Found
from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory

Find = Callable[[NDArray[np.uint8], NDArray[np.bool_] | None], list[Found]]
"""From frames (T, H, W, 3) and pixels to ignore (T, H, W) to what is found in each frame, heaviest first."""


class FinderParams(Section):
    """Which finds are believed."""

    least_share: float = Field(ge=0, le=1)
    """Mass that a find must have, relative to the heaviest in its frame; less is lost rather than wrong."""


class FinderTracker:
    """The heaviest finds of every frame, as many as there are objects, linked over time."""

    def __init__(self, find: Find, params: FinderParams):
        self.find, self.params = find, params

    def track_all(
        self, frames: NDArray[np.uint8], objects: int, ignore: NDArray[np.bool_] | None = None
    ) -> list[Trajectory]:
        """A trajectory an object; one is lost where fewer things than objects are found.

        The score is the find's part of all that was found in the frame.
        """
        believed = [_heaviest(each, objects, self.params.least_share) for each in self.find(frames, ignore)]
        xy, score = link(believed, objects, far_px=float(np.hypot(*frames.shape[1:3])))
        return [Trajectory(xy[:, k], score[:, k]) for k in range(objects)]


def _heaviest(found: Found, objects: int, least_share: float) -> Found:
    count = min(objects, int((found.share >= least_share * found.share.max(initial=0)).sum()))
    return Found(found.xy[:count], found.share[:count])


def link(found: list[Found], objects: int, far_px: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(T, K, 2) positions, NaN where lost, and (T, K) shares: each frame's finds, at most K, to K objects.

    By least total distance from where each was last seen; how it moved there is no help to balls that bounce. One
    that was never seen takes what the others leave: to it everything is `far_px`, more than any distance in the frame.
    """
    xy = np.full((len(found), objects, 2), np.nan, np.float32)
    score = np.zeros((len(found), objects), np.float32)
    last = np.full((objects, 2), np.nan)
    for t, (places, share) in enumerate(found):
        cost = np.nan_to_num(cdist(last, places), nan=far_px)
        who, what = linear_sum_assignment(cost)
        xy[t, who], score[t, who] = places[what], share[what]
        last[who] = places[what]
    return xy, score
