"""Trackers that look at no pixel: what every real tracker must beat."""

import numpy as np
from numpy.typing import NDArray

from physpipe.trackers.base import Trajectory, required


class Persistence:
    """The object stays where it started."""

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """The start in every frame, with score 0: nothing was seen."""
        return _everywhere(len(frames), required(start, frames, "persistence"))


class Centre:
    """Every object is in the middle of the frame: "Const." in the paper's ablation figure."""

    def track_all(
        self, frames: NDArray[np.uint8], objects: int, ignore: NDArray[np.bool_] | None = None
    ) -> list[Trajectory]:
        """The frame's centre in every frame, with score 0: nothing was seen."""
        T, H, W = frames.shape[:3]
        return [_everywhere(T, np.array([(W - 1) / 2, (H - 1) / 2]))] * objects


def _everywhere(T: int, xy: NDArray[np.floating]) -> Trajectory:
    return Trajectory(np.tile(xy.astype(np.float32), (T, 1)), np.zeros(T, np.float32))
