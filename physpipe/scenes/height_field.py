"""Random height-fields: smooth hills and dips inside a border that rises."""

import math
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from physpipe.scenes.terrain import Floats, Terrain, TerrainParams

GRID = 65  # points along each axis at which relief and bend are measured: far finer than any hill


class HeightsParams(TerrainParams):
    """Gaussian hills and dips on a round ground whose border rises as the fourth power of the distance."""

    kind: Literal["heights"]
    """Name in TERRAINS."""
    radius_m: float = Field(gt=0)
    """Radius of the border seen from above, in metres."""
    rim_m: float = Field(ge=0)
    """How far the border alone rises above the middle, in metres."""
    hills: int = Field(ge=1)
    """Hills and dips together."""
    hill_width_m: tuple[float, float]
    """Range of a hill's standard deviation, in metres."""
    relief_m: tuple[float, float]
    """Range of the height from the lowest dip to the highest hill, without the rim, in metres."""
    tightest_m: float = Field(gt=0)
    """Smallest radius of bend: hills that bend tighter are flattened together."""

    @model_validator(mode="after")
    def _ranges_are_positive_and_rim_is_no_tighter_than_allowed(self) -> "HeightsParams":
        for low, high in (self.hill_width_m, self.relief_m):
            if not 0 < low <= high:
                raise ValueError(f"[{low}, {high}] is no range of positive lengths")
        if 12 * self.rim_m * self.tightest_m >= self.radius_m**2:
            raise ValueError("the rim alone bends tighter than tightest_m: lower rim_m")
        return self


class HeightField(Terrain):
    """h = rim (r/R)^4 + sum of a exp(-d^2 / 2 s^2), moved so that the lowest point has height 0."""

    def __init__(self, params: HeightsParams, rng: np.random.Generator):
        self._radius, self._steep = params.radius_m, params.rim_m / params.radius_m**4
        count = params.hills
        reach = params.radius_m * np.sqrt(rng.uniform(0, 1, count))  # evenly over the disc
        azimuth = rng.uniform(0, 2 * np.pi, count)
        centre = np.stack([reach * np.cos(azimuth), reach * np.sin(azimuth)], axis=1)
        sharpness = 0.5 / rng.uniform(*params.hill_width_m, count) ** 2
        amplitude = rng.uniform(0.5, 1, count) * rng.choice([-1.0, 1.0], count)
        relief = rng.uniform(*params.relief_m)
        self._hills = np.column_stack([centre, sharpness, amplitude])
        self._lowest = 0.0
        x, y = self._inner_grid()
        hills = self.height(x, y) - self._steep * (x * x + y * y) ** 2
        scale = min(relief / np.ptp(hills), self._gentlest(x, y, 1 / params.tightest_m))
        self._hills[:, 3] *= scale
        self._lowest = float(self.height(x, y).min())
        self._plain = [tuple(hill) for hill in self._hills.tolist()]

    def height(self, x: Floats, y: Floats) -> Floats:
        inward = 1 / np.maximum(self.level(x, y), 1)
        x, y = x * inward, y * inward
        total = self._steep * (x * x + y * y) ** 2 - self._lowest
        for cx, cy, sharpness, amplitude in self._hills:
            total = total + amplitude * np.exp(-sharpness * ((x - cx) ** 2 + (y - cy) ** 2))
        return total

    def height_and_slope(self, x: float, y: float) -> tuple[float, float, float]:
        square = x * x + y * y
        height, rise = self._steep * square * square - self._lowest, 4 * self._steep * square
        slope_x, slope_y = rise * x, rise * y
        for cx, cy, sharpness, amplitude in self._plain:
            dx, dy = x - cx, y - cy
            hill = amplitude * math.exp(-sharpness * (dx * dx + dy * dy))
            height += hill
            slope_x -= 2 * sharpness * dx * hill
            slope_y -= 2 * sharpness * dy * hill
        return height, slope_x, slope_y

    def foot(self, x: float, y: float, centre: tuple[float, float, float]) -> tuple[float, float]:
        """One step of Newton's method on (c - q) x n(q) = 0: bends nearly as tight as balls would need many rounds."""
        cx, cy, cz = centre
        height, slope_x, slope_y, xx, xy, yy = self._derivatives(x, y)
        above = cz - height
        miss_x, miss_y = cx - x + slope_x * above, cy - y + slope_y * above
        a, d = 1 + slope_x * slope_x - xx * above, 1 + slope_y * slope_y - yy * above
        b = slope_x * slope_y - xy * above
        determinant = a * d - b * b
        return x + (d * miss_x - b * miss_y) / determinant, y + (a * miss_y - b * miss_x) / determinant

    def level(self, x: Floats, y: Floats) -> Floats:
        return np.hypot(x, y) / self._radius

    def point(self, level: float, azimuth: float) -> tuple[float, float]:
        return level * self._radius * math.cos(azimuth), level * self._radius * math.sin(azimuth)

    def _derivatives(self, x: float, y: float) -> tuple[float, float, float, float, float, float]:
        """h, dh/dx, dh/dy, and the second derivatives xx, xy, yy at one point."""
        rim = 4 * self._steep
        square = x * x + y * y
        height, slope_x, slope_y = rim / 4 * square * square - self._lowest, rim * square * x, rim * square * y
        xx, xy, yy = rim * (square + 2 * x * x), rim * 2 * x * y, rim * (square + 2 * y * y)
        for cx, cy, sharpness, amplitude in self._plain:
            dx, dy, twice = x - cx, y - cy, 2 * sharpness
            hill = amplitude * math.exp(-sharpness * (dx * dx + dy * dy))
            height += hill
            slope = twice * hill
            slope_x -= slope * dx
            slope_y -= slope * dy
            xx += slope * (twice * dx * dx - 1)
            xy += slope * twice * dx * dy
            yy += slope * (twice * dy * dy - 1)
        return height, slope_x, slope_y, xx, xy, yy

    def bend(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Largest second derivative along any direction, in 1/m, of the rim and of the hills: curvature is no more."""
        square = x * x + y * y
        xx = yy = xy = np.zeros(np.shape(square))
        for cx, cy, sharpness, amplitude in self._hills:
            dx, dy = x - cx, y - cy
            hill = 2 * sharpness * amplitude * np.exp(-sharpness * (dx * dx + dy * dy))
            xx = xx + hill * (2 * sharpness * dx * dx - 1)
            yy = yy + hill * (2 * sharpness * dy * dy - 1)
            xy = xy + hill * 2 * sharpness * dx * dy
        return 12 * self._steep * square, np.abs(xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)

    def _gentlest(self, x: Floats, y: Floats, limit: float) -> float:
        """The largest factor on the hills with which rim and hills together bend no more than `limit`."""
        rim, hills = self.bend(x, y)
        return float(((limit - rim) / hills).min())

    def _inner_grid(self) -> tuple[Floats, Floats]:
        side = np.linspace(-self._radius, self._radius, GRID)
        x, y = (axis.ravel() for axis in np.meshgrid(side, side))
        inside = self.level(x, y) <= 1
        return x[inside], y[inside]
