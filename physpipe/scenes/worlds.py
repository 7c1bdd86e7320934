"""A whole clip: draw a world at random, let its balls roll, film it."""

import zlib
from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.errors import InputError
from physpipe.core.parallel import in_parallel
from physpipe.core.params import Section
from physpipe.io.recordings import Recording
from physpipe.scenes.film import Camera, CameraParams, encode
from physpipe.scenes.look import LookParams
from physpipe.scenes.physics import LeftTerrainError, PhysicsParams, Start, Trajectory, roll
from physpipe.scenes.render import Scene
from physpipe.scenes.terrain import TERRAINS, BowlParams, Terrain

TRIES = 200  # worlds drawn for one clip before the params are called impossible


class BallsParams(Section):
    """How many balls, and how each is let go."""

    rgb: list[tuple[int, int, int]] = Field(min_length=1)
    """Colour of each ball, 0 to 255; its length is the number of balls, its order their numbers."""
    radius_m: float = Field(gt=0)
    """Radius of every ball, in metres."""
    start_level: tuple[float, float]
    """Range of the distance from the middle at the start, in parts of the distance to the border."""
    start_speed_m_s: tuple[float, float]
    """Range of the speed at the start, in metres per second."""
    heading_spread_deg: float = Field(ge=0, le=180)
    """Largest angle between a ball's first heading and the way to the middle; 180 is any direction."""


class WorldParams(Section):
    """A simulated data set."""

    clips: int = Field(ge=1)
    """Number of recordings."""
    still_frames: tuple[int, int]
    """Range of the number of source frames during which the balls are held before they are let go."""
    moving_frames: int = Field(ge=2)
    """Source frames from the release on."""
    terrain: BowlParams
    balls: BallsParams
    physics: PhysicsParams
    look: LookParams
    camera: CameraParams


def simulate(params: WorldParams, name: str) -> Iterator[Recording]:
    """The recordings of the data set `name`, in order; a clip depends on nothing but params, name and its number."""
    yield from in_parallel(partial(record, params, name), range(params.clips), f"simulate {name}")


def record(params: WorldParams, name: str, number: int) -> Recording:
    """One filmed clip and the exact centres of its balls in source pixels."""
    world_rng, film_rng = _generators(name, number)
    terrain, trajectory = _roll_inside(params, world_rng)
    still = int(film_rng.integers(*params.still_frames, endpoint=True))
    xyz = np.concatenate([np.repeat(trajectory.xyz_m[:1], still, axis=0), trajectory.xyz_m])
    camera = Camera(params.camera, len(xyz), film_rng)
    scene = Scene(params.look, terrain, camera, film_rng)
    xy = camera.project(xyz)
    frames = camera.expose(scene.film(xyz, xy, params.balls.radius_m, params.balls.rgb))
    return Recording(f"clip_{number:04d}.mp4", encode(frames, params.camera), xy)


def track(params: WorldParams, name: str, number: int) -> Trajectory:
    """The motion of clip `number` from the release on, without filming it: some 20 ms."""
    return _roll_inside(params, _generators(name, number)[0])[1]


def _generators(name: str, number: int) -> list[np.random.Generator]:
    """One for the world and one for its filming, so that `track` and `record` see the same world."""
    return np.random.default_rng([zlib.crc32(name.encode()), number]).spawn(2)


def _roll_inside(params: WorldParams, rng: np.random.Generator) -> tuple[Terrain, Trajectory]:
    """Draws worlds until one keeps its balls on the terrain; raises InputError after TRIES of them."""
    for _ in range(TRIES):
        terrain = TERRAINS[params.terrain.kind](params.terrain, rng)
        start = _start(params.balls, terrain, rng)
        if _overlap(start.foot_m, params.balls.radius_m):
            continue
        try:
            return terrain, roll(
                terrain, start, params.balls.radius_m, params.moving_frames, params.camera.fps, params.physics
            )
        except LeftTerrainError:
            continue
    raise InputError("simulate", f"no ball stayed on the terrain in {TRIES} worlds", "lower the start speed or level")


def _start(params: BallsParams, terrain: Terrain, rng: np.random.Generator) -> Start:
    count, spread = len(params.rgb), np.deg2rad(params.heading_spread_deg)
    # Evenly around the middle, so that several balls start apart.
    azimuth = rng.uniform(0, 2 * np.pi) + np.arange(count) * 2 * np.pi / count
    level = rng.uniform(*params.start_level, count)
    foot = np.array([terrain.point(*place) for place in zip(level, azimuth, strict=True)])
    inward = np.arctan2(-foot[:, 1], -foot[:, 0])
    return Start(foot, inward + rng.uniform(-spread, spread, count), rng.uniform(*params.start_speed_m_s, count))


def _overlap(foot: NDArray[np.float64], radius_m: float) -> bool:
    """Whether two balls would start closer than touching, seen from above."""
    gaps = np.linalg.norm(foot[:, None] - foot, axis=-1) + np.diag(np.full(len(foot), np.inf))
    return bool((gaps < 2.5 * radius_m).any())
