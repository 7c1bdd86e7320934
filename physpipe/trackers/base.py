"""What every tracker is: frames in, one object's trajectory out."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from physpipe.core.errors import InputError


@dataclass(frozen=True)
class Trajectory:
    """Where one object is in every frame of a clip."""

    xy: NDArray[np.float32]
    """(T, 2) clip pixels, NaN where the object is lost."""
    score: NDArray[np.float32]
    """(T,) confidence in [0, 1]."""
    ambiguous: NDArray[np.bool_] | None = None
    """(T,) frames in which it may be another object of the same kind; None where a tracker does not say."""
    still: bool = False
    """Whether it was seen not to move in the whole clip, as far as a tracker says."""


class Tracker(Protocol):
    """Finds one object in a clip."""

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """The object's trajectory in `frames` (T, H, W, 3).

        `start` (2,) is its place in the first frame in pixels, for methods that need one (they raise InputError
        without it); `ignore` (T, H, W) marks pixels where nothing may be found.
        """
        ...


class JointTracker(Protocol):
    """Finds all objects of a clip together, told nothing but at most how many there are."""

    def track_all(
        self, frames: NDArray[np.uint8], objects: int, ignore: NDArray[np.bool_] | None = None
    ) -> list[Trajectory]:
        """A trajectory an object, in no particular order; `ignore` as in `Tracker`."""
        ...


def required(start: NDArray[np.floating] | None, frames: NDArray[np.uint8], tracker: str) -> NDArray[np.floating]:
    """`start` itself; raises InputError when there is none, or when it lies outside the frame."""
    where = f"tracker `{tracker}`"
    if start is None:
        raise InputError(
            where,
            "needs the object's place in the first frame",
            "annotate the clip or drop the tracker from `baselines.names`",
        )
    H, W = frames.shape[1:3]
    x, y = (float(each) for each in start)
    if not (-0.5 <= x <= W - 0.5 and -0.5 <= y <= H - 0.5):  # NaN is not inside either
        reason = f"starts at x = {x:g}, y = {y:g}, outside the frame of {W} x {H} pixels"
        raise InputError(where, reason, "give the start in pixels of the clip's frame")
    return start
