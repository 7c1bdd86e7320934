"""Surfaces that balls roll on: heights in metres over the horizontal plane, and where their border lies."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physpipe.core.params import Section

Floats = NDArray[np.float64]


class TerrainParams(Section):
    """What every kind of terrain is told."""

    fixed: bool
    """True: one terrain, surface included, for the whole data set; false: drawn anew for every clip."""


@dataclass(frozen=True)
class Wall:
    """An upright plane that throws balls back."""

    xy_m: tuple[float, float]
    """A point of it, in metres."""
    inward: tuple[float, float]
    """Its unit normal, horizontal, towards the balls."""
    restitution: float
    """Speed away from it over speed towards it, in (0, 1]."""


class Terrain(ABC):
    """A smooth height function h(x, y) that one ball touches at one point: no tighter bend than the ball."""

    walls: tuple[Wall, ...] = ()

    @abstractmethod
    def height(self, x: Floats, y: Floats) -> Floats:
        """Height in metres above the lowest point, of any shape; held at the border's height outside it."""

    @abstractmethod
    def height_and_slope(self, x: float, y: float) -> tuple[float, float, float]:
        """(h, dh/dx, dh/dy) at one point inside the border: plain floats, since physics asks at every step."""

    @abstractmethod
    def level(self, x: Floats, y: Floats) -> Floats:
        """How far out a point lies: 0 at the middle, 1 on the border."""

    @abstractmethod
    def point(self, level: float, azimuth: float) -> tuple[float, float]:
        """The (x, y) in metres at a level, in the direction `azimuth` (radians) of the terrain's own frame."""

    def foot(self, x: float, y: float, centre: tuple[float, float, float]) -> tuple[float, float]:
        """The point nearest to a ball's centre, from (x, y), where it was a physics step ago.

        The nearest point q has c = q + d n(q): q -> c - d n(q) contracts by d over the terrain's radius of bend, and q
        hardly moves in a step, so two rounds reach rounding error where that radius is many times the ball's.
        """
        cx, cy, cz = centre
        for _ in range(2):
            height, slope_x, slope_y = self.height_and_slope(x, y)
            norm2 = 1 + slope_x * slope_x + slope_y * slope_y
            distance = (cz - height - slope_x * (cx - x) - slope_y * (cy - y)) / norm2
            x, y = cx + distance * slope_x, cy + distance * slope_y
        return x, y

    def holds(self, x: Floats, y: Floats, radius_m: Floats) -> bool:
        """Whether all balls centred over (K,) x, y lie within the border, edges included."""
        outward = 1 + radius_m / np.maximum(np.hypot(x, y), radius_m)
        return bool((self.level(x * outward, y * outward) < 1).all())
