"""The energy of balls that follow a path in a simulated film's picture: what a forecast wins or loses without a cause
(ours).

A path in the picture has a height, as the ball touches the terrain, and so it has potential and kinetic energy. Spin is
that of rolling without slipping, or none where the terrain is slippery; a spin about the terrain's normal is not told.
"""

import numpy as np

from physpipe.scenes.physics import DENSITY, PhysicsParams
from physpipe.scenes.terrain import Floats, Terrain
from physpipe.scenes.worlds import World

ROUNDS = 8
"""Of finding where a ball touches: each leaves an error as many times smaller as the terrain bends less than a ball."""
SLOPE = np.array([1, -8, 0, 8, -1]) / 12
"""Derivative by differences of the fourth order: chords of the second are too short on a tight bend."""
ROLLING, SLIDING = 7 / 10, 1 / 2
"""Kinetic energy of a solid ball over mass and speed squared."""


def energy_j(world: World, physics: PhysicsParams, xyz_m: Floats, apart_s: float) -> float:
    """Of balls that are centred at (5, K, 3) at five moments, `apart_s` seconds apart, in the middle one; in joules.

    0 is for balls at rest at the terrain's lowest point.
    """
    radius = np.array([ball.radius_m for ball in world.balls])
    mass = DENSITY * 4 / 3 * np.pi * radius**3
    velocity = np.tensordot(SLOPE, xyz_m, 1) / apart_s  # (K, 3)
    kinetic = (ROLLING if physics.friction > 0 else SLIDING) * np.square(velocity).sum(axis=1)
    potential = physics.gravity_m_s2 * (xyz_m[2, :, 2] - radius)
    return float((mass * (kinetic + potential)).sum())


def lifted(world: World, xy_m: Floats) -> Floats:
    """(T, K, 3) centres of the balls that touch the terrain, seen from above at (T, K, 2).

    Beyond the border, where no ball gets, the terrain goes on level.
    """
    radii = [ball.radius_m for ball in world.balls]
    return np.array(
        [
            [(x, y, _height(world.terrain, x, y, radius)) for (x, y), radius in zip(each, radii, strict=True)]
            for each in xy_m.tolist()
        ]
    )


def _height(terrain: Terrain, x: float, y: float, radius_m: float) -> float:
    """Of the centre, over the lowest point of the terrain."""
    foot_x, foot_y, centre = x, y, 0.0
    for _ in range(ROUNDS):
        if not terrain.level(np.array(foot_x), np.array(foot_y)) < 1:
            return float(terrain.height(np.array(x), np.array(y))) + radius_m
        height, slope_x, slope_y = terrain.height_and_slope(foot_x, foot_y)
        upright = radius_m / (1 + slope_x * slope_x + slope_y * slope_y) ** 0.5
        foot_x, foot_y, centre = x + slope_x * upright, y + slope_y * upright, height + upright
    return centre
