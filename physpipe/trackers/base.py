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


def required(start: NDArray[np.floating] | None, tracker: str) -> NDArray[np.floating]:
    """`start` itself; raises InputError when there is none."""
    if start is None:
        raise InputError(
            f"tracker `{tracker}`",
            "needs the object's place in the first frame",
            "annotate the clip or drop the tracker",
        )
    return start
