"""Source pixels <-> clip pixels.

Both count from the centre of the top-left pixel, x right, y down, so a pixel's area spans
[x - 1/2, x + 1/2] and a resize maps edges, not centres, onto edges.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Geometry:
    """Where a clip's frame lies in its source: a crop box and the size it was resized to, in pixels."""

    left: float
    top: float
    crop_width: float
    crop_height: float
    width: int
    height: int

    @property
    def scale(self) -> NDArray[np.float64]:
        """Clip pixels per source pixel, (x, y)."""
        return np.array([self.width / self.crop_width, self.height / self.crop_height])

    def to_clip(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(..., 2) source pixels to (..., 2) clip pixels."""
        return (np.asarray(xy, np.float64) + 0.5 - [self.left, self.top]) * self.scale - 0.5

    def to_source(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(..., 2) clip pixels to (..., 2) source pixels."""
        return (np.asarray(xy, np.float64) + 0.5) / self.scale + [self.left, self.top] - 0.5
