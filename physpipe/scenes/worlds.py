"""A whole clip: draw a world at random, let its balls roll, film it."""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from physpipe.core.errors import InputError
from physpipe.core.parallel import in_parallel
from physpipe.io.recordings import Recording
from physpipe.scenes.balls import Ball
from physpipe.scenes.film import Camera, encode
from physpipe.scenes.physics import LeftTerrainError, Start, Trajectory, roll
from physpipe.scenes.render import Scene
from physpipe.scenes.terrain import Floats, Terrain, Wall
from physpipe.scenes.terrains import draw_at_random
from physpipe.scenes.world_params import BallsParams, WorldParams

PREFIX = "clip_"
TRIES = 200  # worlds drawn for one clip before the params are called impossible


@dataclass(frozen=True)
class Chances:
    """Independent generators of one clip, so that what one of them is asked for does not change the others."""

    world: np.random.Generator
    """Terrain, unless it is fixed, and start."""
    film: np.random.Generator
    """Camera, light and surface, unless it is fixed."""
    balls: np.random.Generator
    """Colours and radii."""
    fixed_terrain: np.random.Generator
    """The same for all clips of a set."""
    fixed_surface: np.random.Generator
    """The same for all clips of a set."""

    @classmethod
    def of(cls, name: str, number: int) -> "Chances":
        clip = np.random.default_rng([zlib.crc32(name.encode()), number])
        every = np.random.default_rng(zlib.crc32(f"every clip of {name}".encode()))
        return cls(*clip.spawn(3), *every.spawn(2))


@dataclass(frozen=True)
class World:
    """What one clip films."""

    terrain: Terrain
    balls: list[Ball]
    xyz_m: Floats
    """(F, K, 3) centres in every source frame, z up."""
    camera: Camera


def simulate(params: WorldParams, name: str) -> Iterator[Recording]:
    """The recordings of the data set `name`, in order; a clip depends on nothing but params, name and its number."""
    yield from in_parallel(partial(record, params, name), range(params.clips), f"simulate {name}")


def record(params: WorldParams, name: str, number: int) -> Recording:
    """One filmed clip and the exact centres of its balls in source pixels."""
    chances = Chances.of(name, number)
    world = draw_world(params, chances)
    scene = Scene(params.look, world.terrain, world.camera, chances.film, surface_rng(params, chances))
    xy = world.camera.project(world.xyz_m)
    frames = world.camera.expose(scene.film(world.xyz_m, xy, world.balls))
    return Recording(f"{PREFIX}{number:04d}.mp4", encode(frames, params.camera), xy)


def number_of(source: str) -> int:
    """The number of the clip that the recording `source` is of."""
    return int(source.removeprefix(PREFIX).removesuffix(".mp4"))


def draw_world(params: WorldParams, chances: Chances) -> World:
    """What a clip films, without filming it."""
    balls = draw_balls(params, chances.balls)
    terrain, trajectory = _roll_inside(params, balls, chances)
    still = int(chances.film.integers(*params.still_frames, endpoint=True))
    xyz = np.concatenate([np.repeat(trajectory.xyz_m[:1], still, axis=0), trajectory.xyz_m])
    return World(terrain, balls, xyz, Camera(params.camera, len(xyz), chances.film))


def track(params: WorldParams, name: str, number: int) -> Trajectory:
    """The motion of clip `number` from the release on, without filming it: the cheaper half."""
    chances = Chances.of(name, number)
    return _roll_inside(params, draw_balls(params, chances.balls), chances)[1]


def draw_balls(params: WorldParams, rng: np.random.Generator) -> list[Ball]:
    """The balls of one clip."""
    count = params.balls.count
    if params.balls.colours == "listed":
        order = list(range(count))
    elif params.balls.colours == "different":
        order = rng.permutation(len(params.palette))[:count].tolist()
    else:
        order = [int(rng.integers(len(params.palette)))] * count
    radii = rng.uniform(*params.balls.radius_m, count).tolist()
    return [Ball(params.palette[colour], radius) for colour, radius in zip(order, radii, strict=True)]


def terrain_of(params: WorldParams, chances: Chances) -> Terrain:
    """The set's terrain where it is fixed, else a new one."""
    return draw_at_random(params.terrain, chances.fixed_terrain if params.terrain.fixed else chances.world)


def surface_rng(params: WorldParams, chances: Chances) -> np.random.Generator:
    """What draws the terrain's brightness and texture."""
    return chances.fixed_surface if params.terrain.fixed else chances.film


def _roll_inside(params: WorldParams, balls: list[Ball], chances: Chances) -> tuple[Terrain, Trajectory]:
    """Draws worlds until one keeps its balls on the terrain; raises InputError after TRIES of them."""
    radius_m = np.array([ball.radius_m for ball in balls])
    terrain = terrain_of(params, chances)
    for tried in range(TRIES):
        if tried and not params.terrain.fixed:
            terrain = terrain_of(params, chances)
        start = _start(params.balls, terrain, chances.world)
        if _overlap(start.foot_m, radius_m, terrain.walls):
            continue
        try:
            return terrain, roll(terrain, start, radius_m, params.moving_frames, params.camera.fps, params.physics)
        except LeftTerrainError:
            continue
    raise InputError("simulate", f"no ball stayed on the terrain in {TRIES} worlds", "lower the start speed or level")


def _start(params: BallsParams, terrain: Terrain, rng: np.random.Generator) -> Start:
    count, spread = params.count, np.deg2rad(params.heading_spread_deg)
    # Evenly around the middle, so that several balls start apart.
    azimuth = rng.uniform(0, 2 * np.pi) + np.arange(count) * 2 * np.pi / count
    level = rng.uniform(*params.start_level, count)
    foot = np.array([terrain.point(*place) for place in zip(level, azimuth, strict=True)])
    inward = np.arctan2(-foot[:, 1], -foot[:, 0])
    return Start(foot, inward + rng.uniform(-spread, spread, count), rng.uniform(*params.start_speed_m_s, count))


def _overlap(foot: Floats, radius_m: Floats, walls: tuple[Wall, ...]) -> bool:
    """Whether two balls, or a ball and a wall, would start closer than touching, seen from above."""
    gaps = np.linalg.norm(foot[:, None] - foot, axis=-1) + np.diag(np.full(len(foot), np.inf))
    from_walls = [(foot - wall.xy_m) @ np.array(wall.inward) for wall in walls]
    near = 1.25 * (radius_m[:, None] + radius_m)
    return bool((gaps < near).any() or any((gap < 1.25 * radius_m).any() for gap in from_walls))
