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
from physpipe.scenes.terrain import Floats, Terrain, Wall

DENSITY = 700.0  # kg/m^3; without air drag no motion depends on it
IMPEDANCE = 0.99  # MuJoCo's share of a contact that is enforced: below 1 so that its solver stays well posed


class PhysicsParams(Section):
    """What governs the motion, whatever the terrain."""

    gravity_m_s2: float = Field(ge=0)
    """Downward acceleration, in metres per second squared."""
    steps_per_frame: int = Field(ge=1)
    """Physics steps between two source frames."""
    contact_s: float = Field(gt=0)
    """How long two balls, or a ball and a wall, touch when they collide, in seconds; several physics steps."""
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
    radius_m: Floats,
    frames: int,
    fps: float,
    params: PhysicsParams,
) -> Trajectory:
    """Rolls balls of (K,) `radius_m` for `frames` moments, 1/fps apart.

    Raises LeftTerrainError when a ball's edge reaches the border.
    """
    model = _model(radius_m, terrain.walls, fps, params)
    data = mujoco.MjData(model)
    feet = _place(data, terrain, start, radius_m)
    xyz, energy = np.empty((frames, len(feet), 3)), np.empty(frames)
    for frame in range(frames):
        xyz[frame] = data.qpos.reshape(-1, 7)[:, :3]
        if not terrain.holds(xyz[frame, :, 0], xyz[frame, :, 1], radius_m):
            raise LeftTerrainError
        for step in range(params.steps_per_frame):
            feet = _lay_planes(data, terrain, feet)
            mujoco.mj_step(model, data)
            if step == 0:  # MuJoCo gives the energy of the moment at which the step began
                energy[frame] = data.energy.sum()
    return Trajectory(xyz, energy)


def _model(radius_m: Floats, walls: tuple[Wall, ...], fps: float, params: PhysicsParams) -> mujoco.MjModel:
    """Free balls and planes; only ball i with plane i, balls with each other and balls with walls may touch."""
    ground = f'{_contact(1, params)} solreffriction="{params.contact_s} 1" condim="{_condim(params)}"'
    grip = f"{params.friction} {params.friction} 0 {params.rolling_resistance_m} {params.rolling_resistance_m}"
    # Smooth balls: friction between them would make a rolling one climb the other. Smooth walls: they would spin it.
    knock = f'{_contact(params.restitution, params)} condim="1"'
    bodies = "".join(
        f'<body mocap="true"><geom name="plane{k}" type="plane" size="1 1 1"/></body>'
        f'<body><freejoint/><geom name="ball{k}" size="{radius}" density="{DENSITY}"/></body>'
        for k, radius in enumerate(radius_m.tolist())
    )
    pairs = [f'<pair geom1="plane{k}" geom2="ball{k}" {ground} friction="{grip}"/>' for k in range(len(radius_m))]
    pairs += [f'<pair geom1="ball{i}" geom2="ball{k}" {knock}/>' for k in range(len(radius_m)) for i in range(k)]
    for i, wall in enumerate(walls):
        (x, y), (nx, ny) = wall.xy_m, wall.inward
        bodies += f'<geom name="wall{i}" type="plane" size="1 1 1" pos="{x} {y} 0" zaxis="{nx} {ny} 0"/>'
        bounce = f'{_contact(wall.restitution, params)} condim="1"'
        pairs += [f'<pair geom1="wall{i}" geom2="ball{k}" {bounce}/>' for k in range(len(radius_m))]
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


def _contact(restitution: float, params: PhysicsParams) -> str:
    """Stiffness and damping of a contact that lasts `contact_s` and keeps `restitution` of the speed."""
    stiffness, loss = (np.pi / params.contact_s) ** 2, -np.log(restitution)
    damping = 2 * np.sqrt(stiffness) * loss / np.hypot(np.pi, loss)
    return f'solimp="{IMPEDANCE} {IMPEDANCE} 1" solref="{-stiffness} {-damping}"'


def _condim(params: PhysicsParams) -> int:
    """MuJoCo's number of contact forces: 1 normal, 3 with sliding, 6 with rolling; it raises zeros to 1e-5."""
    if params.rolling_resistance_m > 0:
        return 6
    return 3 if params.friction > 0 else 1


def _place(data: mujoco.MjData, terrain: Terrain, start: Start, radius_m: Floats) -> list[tuple[float, float]]:
    """Puts the balls on the terrain, rolling without slipping; gives the points where they touch it."""
    feet = [(float(x), float(y)) for x, y in start.foot_m]
    for k, (x, y) in enumerate(feet):
        height, slope_x, slope_y = terrain.height_and_slope(x, y)
        normal = np.array([-slope_x, -slope_y, 1.0])
        normal /= np.linalg.norm(normal)
        ahead = np.array([np.cos(start.heading[k]), np.sin(start.heading[k]), 0.0])
        ahead[2] = ahead[0] * slope_x + ahead[1] * slope_y
        velocity = start.speed_m_s[k] * ahead / np.linalg.norm(ahead)
        data.qpos[7 * k : 7 * k + 3] = (x, y, height) + radius_m[k] * normal
        data.qvel[6 * k : 6 * k + 3] = velocity
        data.qvel[6 * k + 3 : 6 * k + 6] = np.cross(normal, velocity) / radius_m[k]
    return feet


def _lay_planes(data: mujoco.MjData, terrain: Terrain, feet: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Moves each plane under its ball; `feet` are the last points of contact, the result the new ones."""
    moved = []
    for k, (x, y) in enumerate(feet):
        cx, cy, cz = data.qpos[7 * k : 7 * k + 3].tolist()
        x, y = terrain.foot(x, y, (cx, cy, cz))
        height, slope_x, slope_y = terrain.height_and_slope(x, y)
        upright = 1 + (1 + slope_x * slope_x + slope_y * slope_y) ** 0.5
        data.mocap_pos[k] = x, y, height
        data.mocap_quat[k] = upright, slope_y, -slope_x, 0  # turns z to the normal; MuJoCo normalises it
        moved.append((x, y))
    return moved
