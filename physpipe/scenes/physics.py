"""Balls rolling on a terrain and knocking into each other, by MuJoCo.

MuJoCo's own height-field is made of flat facets, and every edge costs a rolling ball energy. So each ball gets a
plane of its own, which before every step is laid tangent to the terrain where the ball is nearest to it.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.scenes.terrain import Terrain

DENSITY = 700.0  # kg/m^3; without air drag no motion depends on it
IMPEDANCE = 0.99  # MuJoCo's share of a contact that is enforced: below 1 so that its solver stays well posed


class PhysicsParams(Section):
    """What governs the motion, whatever the terrain."""

    gravity_m_s2: float = Field(ge=0)
    """Downward acceleration, in metres per second squared."""
    steps_per_frame: int = Field(ge=1)
    """Physics steps between two source frames."""
    contact_s: float = Field(gt=0)
    """How long two balls touch when they collide, in seconds; several physics steps."""
    friction: float = Field(ge=0)
    """Coulomb coefficient between ball and terrain; 0 slides, above about 0.4 rolls without slipping."""
    rolling_resistance_m: float = Field(ge=0)
    """Coefficient of rolling friction, in metres."""
    restitution: float = Field(gt=0, le=1)
    """Speed of parting over speed of meeting when two balls collide; 1 loses no energy."""


@dataclass(frozen=True)
class Start:
    """Where and how K balls are let go."""

    foot_m: NDArray[np.float64]
    """(K, 2) horizontal position of the points that touch the terrain."""
    heading: NDArray[np.float64]
    """(K,) direction of the velocity seen from above, in radians."""
    speed_m_s: NDArray[np.float64]
    """(K,) speed along the terrain."""


@dataclass(frozen=True)
class Trajectory:
    """Motion of K balls at F moments, the first being the release."""

    xyz_m: NDArray[np.float64]
    """(F, K, 3) centres, z up."""
    energy_j: NDArray[np.float64]
    """(F,) potential and kinetic energy of all balls; potential counts from the terrain's bottom."""


class LeftTerrainError(Exception):
    """A ball rolled over the border, where the terrain ends."""


def roll(
    terrain: Terrain,
    start: Start,
    radius_m: float,
    frames: int,
    fps: float,
    params: PhysicsParams,
) -> Trajectory:
    """Rolls the balls for `frames` moments, 1/fps apart.

    Raises LeftTerrainError when a ball's edge reaches the border.
    """
    model = _model(len(start.foot_m), radius_m, fps, params)
    data = mujoco.MjData(model)
    feet = _place(data, terrain, start, radius_m)
    xyz, energy = np.empty((frames, len(feet), 3)), np.empty(frames)
    for frame in range(frames):
        xyz[frame] = data.qpos.reshape(-1, 7)[:, :3]
        _check_inside(terrain, xyz[frame], radius_m)
        for step in range(params.steps_per_frame):
            feet = _lay_planes(data, terrain, feet)
            mujoco.mj_step(model, data)
            if step == 0:  # MuJoCo gives the energy of the moment at which the step began
                energy[frame] = data.energy.sum()
    return Trajectory(xyz, energy)


def _model(count: int, radius_m: float, fps: float, params: PhysicsParams) -> mujoco.MjModel:
    """`count` free balls and planes; only ball i with plane i, and balls with each other, may touch."""
    stiffness = (np.pi / params.contact_s) ** 2
    loss = -np.log(params.restitution)
    damping = 2 * np.sqrt(stiffness) * loss / np.hypot(np.pi, loss)
    common = f'solimp="{IMPEDANCE} {IMPEDANCE} 1"'
    ground = f'{common} solref="{-stiffness} 0" solreffriction="{params.contact_s} 1" condim="{_condim(params)}"'
    grip = f"{params.friction} {params.friction} 0 {params.rolling_resistance_m} {params.rolling_resistance_m}"
    # Smooth balls: friction between them would make a rolling one climb the other.
    knock = f'{common} solref="{-stiffness} {-damping}" condim="1"'
    bodies = "".join(
        f'<body mocap="true"><geom name="plane{k}" type="plane" size="1 1 1"/></body>'
        f'<body><freejoint/><geom name="ball{k}" size="{radius_m}" density="{DENSITY}"/></body>'
        for k in range(count)
    )
    pairs = [f'<pair geom1="plane{k}" geom2="ball{k}" {ground} friction="{grip}"/>' for k in range(count)]
    pairs += [f'<pair geom1="ball{i}" geom2="ball{k}" {knock}/>' for k in range(count) for i in range(k)]
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco>
        <option gravity="0 0 {-params.gravity_m_s2}" timestep="{1 / fps / params.steps_per_frame}" cone="elliptic">
            <flag energy="enable"/>
        </option>
        <default><geom contype="0" conaffinity="0"/></default>
        <worldbody>{bodies}</worldbody>
        <contact>{"".join(pairs)}</contact>
        </mujoco>"""
    )


def _condim(params: PhysicsParams) -> int:
    """MuJoCo's number of contact forces: 1 normal, 3 with sliding, 6 with rolling; it raises zeros to 1e-5."""
    if params.rolling_resistance_m > 0:
        return 6
    return 3 if params.friction > 0 else 1


def _place(data: mujoco.MjData, terrain: Terrain, start: Start, radius_m: float) -> list[tuple[float, float]]:
    """Puts the balls on the terrain, rolling without slipping; gives the points where they touch it."""
    feet = [(float(x), float(y)) for x, y in start.foot_m]
    for k, (x, y) in enumerate(feet):
        height, slope_x, slope_y = terrain.height_and_slope(x, y)
        normal = np.array([-slope_x, -slope_y, 1.0])
        normal /= np.linalg.norm(normal)
        ahead = np.array([np.cos(start.heading[k]), np.sin(start.heading[k]), 0.0])
        ahead[2] = ahead[0] * slope_x + ahead[1] * slope_y
        velocity = start.speed_m_s[k] * ahead / np.linalg.norm(ahead)
        data.qpos[7 * k : 7 * k + 3] = (x, y, height) + radius_m * normal
        data.qvel[6 * k : 6 * k + 3] = velocity
        data.qvel[6 * k + 3 : 6 * k + 6] = np.cross(normal, velocity) / radius_m
    return feet


def _lay_planes(data: mujoco.MjData, terrain: Terrain, feet: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Moves each plane under its ball; `feet` are the last points of contact, the result the new ones."""
    moved = []
    for k, (x, y) in enumerate(feet):
        cx, cy, cz = data.qpos[7 * k : 7 * k + 3].tolist()
        # The nearest point q of the terrain has c = q + d n(q): q -> c - d n(q) contracts by d over the terrain's
        # radius of bend, and q hardly moves in a step, so two rounds reach rounding error.
        for _ in range(2):
            height, slope_x, slope_y = terrain.height_and_slope(x, y)
            norm2 = 1 + slope_x * slope_x + slope_y * slope_y
            distance = (cz - height - slope_x * (cx - x) - slope_y * (cy - y)) / norm2
            x, y = cx + distance * slope_x, cy + distance * slope_y
        height, slope_x, slope_y = terrain.height_and_slope(x, y)
        upright = 1 + (1 + slope_x * slope_x + slope_y * slope_y) ** 0.5
        data.mocap_pos[k] = x, y, height
        data.mocap_quat[k] = upright, slope_y, -slope_x, 0  # turns z to the normal; MuJoCo normalises it
        moved.append((x, y))
    return moved


def _check_inside(terrain: Terrain, xyz: NDArray[np.float64], radius_m: float) -> None:
    x, y = xyz[:, 0], xyz[:, 1]
    outward = 1 + radius_m / np.maximum(np.hypot(x, y), radius_m)
    if (terrain.level(x * outward, y * outward) >= 1).any():
        raise LeftTerrainError
