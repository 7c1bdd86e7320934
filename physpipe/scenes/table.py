"""Level tables with cushions."""

from typing import Literal

import numpy as np
from pydantic import Field

from physpipe.scenes.terrain import Floats, Terrain, TerrainParams, Wall


class TableParams(TerrainParams):
    """A level rectangle between four cushions."""

    kind: Literal["table"]
    """Name in TERRAINS."""
    half_sides_m: tuple[float, float]
    """Distance of the cushions from the middle, along x and along y, in metres."""
    restitution: float = Field(gt=0, le=1)
    """Speed away from a cushion over speed towards it; 1 loses none. A cushion gives no spin."""


class Table(Terrain):
    """A pool table; its border is the cushions' noses. Nothing about it is drawn at random."""

    def __init__(self, params: TableParams, rng: np.random.Generator):
        self.half = a, b = params.half_sides_m
        sides = (((a, 0.0), (-1.0, 0.0)), ((-a, 0.0), (1.0, 0.0)), ((0.0, b), (0.0, -1.0)), ((0.0, -b), (0.0, 1.0)))
        self.walls = tuple(Wall(xy, inward, params.restitution) for xy, inward in sides)

    def height(self, x: Floats, y: Floats) -> Floats:
        return np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)))

    def height_and_slope(self, x: float, y: float) -> tuple[float, float, float]:
        return 0.0, 0.0, 0.0

    def level(self, x: Floats, y: Floats) -> Floats:
        return np.maximum(np.abs(x) / self.half[0], np.abs(y) / self.half[1])

    def point(self, level: float, azimuth: float) -> tuple[float, float]:
        dx, dy = float(np.cos(azimuth)), float(np.sin(azimuth))
        reach = level / max(abs(dx) / self.half[0], abs(dy) / self.half[1])
        return reach * dx, reach * dy

    def holds(self, x: Floats, y: Floats, radius_m: Floats) -> bool:
        """Whether no ball has sunk into a cushion by half its radius: a cushion gives way a little at every touch."""
        return bool((np.abs(x) + radius_m / 2 < self.half[0]).all() and (np.abs(y) + radius_m / 2 < self.half[1]).all())
