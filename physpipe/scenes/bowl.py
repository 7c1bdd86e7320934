"""Ellipsoidal bowls."""

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from physpipe.scenes.terrain import Floats, Terrain, TerrainParams

STEEPEST = 1e-3  # keeps an ellipsoid's slope finite where it stands upright, for a ball on its way out


class BowlParams(TerrainParams):
    """An ellipsoid's lower part, cut off level below its equator, turned by any angle about the vertical."""

    kind: Literal["bowl"]
    """Name in TERRAINS."""
    rim_radius_m: tuple[float, float]
    """Range of the rim's two semi-axes, in metres."""
    depth_m: tuple[float, float]
    """Range of the rim's height above the bottom, in metres."""
    cut: float = Field(gt=0, lt=1)
    """Rim's radius over the equator's: near 0 a paraboloid, near 1 a bowl whose wall ends upright."""

    @model_validator(mode="after")
    def _ranges_are_positive_and_ordered(self) -> "BowlParams":
        for low, high in (self.rim_radius_m, self.depth_m):
            if not 0 < low <= high:
                raise ValueError(f"[{low}, {high}] is no range of positive lengths")
        return self


class Bowl(Terrain):
    """An ellipsoidal bowl with its bottom at the origin."""

    def __init__(self, params: BowlParams, rng: np.random.Generator):
        self.rim = rng.uniform(*params.rim_radius_m, 2)  # semi-axes, metres
        self.depth = float(rng.uniform(*params.depth_m))
        yaw = rng.uniform(0, np.pi)
        self._cos, self._sin = float(np.cos(yaw)), float(np.sin(yaw))
        self._a2, self._b2 = (float(axis) for axis in (self.rim / params.cut) ** 2)
        self._c = self.depth / (1 - float(np.sqrt(1 - params.cut**2)))  # vertical semi-axis, metres

    def height(self, x: Floats, y: Floats) -> Floats:
        inward = 1 / np.maximum(self.level(x, y), 1)
        u, v = self._turned(x * inward, y * inward)
        return self._c * (1 - np.sqrt(1 - u**2 / self._a2 - v**2 / self._b2))

    def height_and_slope(self, x: float, y: float) -> tuple[float, float, float]:
        u, v = self._cos * x + self._sin * y, self._cos * y - self._sin * x
        root = max(1 - u * u / self._a2 - v * v / self._b2, STEEPEST) ** 0.5
        du, dv = self._c * u / (self._a2 * root), self._c * v / (self._b2 * root)
        return self._c * (1 - root), self._cos * du - self._sin * dv, self._sin * du + self._cos * dv

    def level(self, x: Floats, y: Floats) -> Floats:
        u, v = self._turned(x, y)
        return np.hypot(u / self.rim[0], v / self.rim[1])

    def point(self, level: float, azimuth: float) -> tuple[float, float]:
        u, v = level * self.rim * (np.cos(azimuth), np.sin(azimuth))
        return float(self._cos * u - self._sin * v), float(self._sin * u + self._cos * v)

    def _turned(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """World to the ellipsoid's own axes."""
        return self._cos * x + self._sin * y, self._cos * y - self._sin * x
