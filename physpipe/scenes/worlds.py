"""A whole clip: draw a world at random, let its balls roll, film it."""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from physpipe.core.errors import InputError
from physpipe.core.parallel import in_parallel
from physpipe.core.params import Section
from physpipe.io.recordings import Recording
from physpipe.scenes.balls import Ball, Rgb
from physpipe.scenes.film import Camera, CameraParams, encode
from physpipe.scenes.height_field import HeightsParams
from physpipe.scenes.look import LookParams
from physpipe.scenes.physics import LeftTerrainError, PhysicsParams, Start, Trajectory, roll
from physpipe.scenes.render import Scene
from physpipe.scenes.terrain import Floats, Terrain, Wall
from physpipe.scenes.terrains import AnyTerrainParams, draw_at_random

TRIES = 200  # worlds drawn for one clip before the params are called impossible


class BallsParams(Section):
    """How many balls, what they are, and how each is let go."""

    count: int = Field(ge=1)
    """Balls in every clip, numbered from 0."""
    colours: Literal["listed", "different", "same"]
    """`listed`: ball i has the palette's colour i; `different`: colours drawn for each clip, no two alike; `same`: one
    colour drawn for each clip."""
    radius_m: tuple[float, float]
    """Range of the radii, each drawn for each ball and clip, in metres."""
    start_level: tuple[float, float]
    """Range of the distance from the middle at the start, in parts of the distance to the border."""
    start_speed_m_s: tuple[float, float]
    """Range of the speed at the start, in metres per second."""
    heading_spread_deg: float = Field(ge=0, le=180)
    """Largest angle between a ball's first heading and the way to the middle; 180 is any direction."""

    @model_validator(mode="after")
    def _radii_are_positive_and_ordered(self) -> "BallsParams":
        if not 0 < self.radius_m[0] <= self.radius_m[1]:
            raise ValueError(f"{list(self.radius_m)} is no range of positive radii")
        return self


class WorldParams(Section):
    """A simulated data set."""

    clips: int = Field(ge=1)
    """Number of recordings."""
    still_frames: tuple[int, int]
    """Range of the number of source frames during which the balls are held before they are let go."""
    moving_frames: int = Field(ge=2)
    """Source frames from the release on."""
    terrain: AnyTerrainParams
    balls: BallsParams
    palette: list[Rgb] = Field(min_length=1)
    """Colours of balls, 0 to 255."""
    physics: PhysicsParams
    look: LookParams
    camera: CameraParams

    @model_validator(mode="after")
    def _palette_suffices(self) -> "WorldParams":
        if self.balls.colours != "same" and self.balls.count > len(self.palette):
            raise ValueError(
                f"{self.balls.count} balls of {self.balls.colours} colours, {len(self.palette)} in palette"
            )
        return self

    @model_validator(mode="after")
    def _no_ball_is_larger_than_the_tightest_bend(self) -> "WorldParams":
        if isinstance(self.terrain, HeightsParams) and self.balls.radius_m[1] >= self.terrain.tightest_m:
            raise ValueError(
                f"balls of {self.balls.radius_m[1]} m on a terrain that bends by {self.terrain.tightest_m} m"
            )
        return self


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


def simulate(params: WorldParams, name: str) -> Iterator[Recording]:
    """The recordings of the data set `name`, in order; a clip depends on nothing but params, name and its number."""
    yield from in_parallel(partial(record, params, name), range(params.clips), f"simulate {name}")


def record(params: WorldParams, name: str, number: int) -> Recording:
    """One filmed clip and the exact centres of its balls in source pixels."""
    chances = Chances.of(name, number)
    balls = draw_balls(params, chances.balls)
    terrain, trajectory = _roll_inside(params, balls, chances)
    still = int(chances.film.integers(*params.still_frames, endpoint=True))
    xyz = np.concatenate([np.repeat(trajectory.xyz_m[:1], still, axis=0), trajectory.xyz_m])
    camera = Camera(params.camera, len(xyz), chances.film)
    scene = Scene(params.look, terrain, camera, chances.film, surface_rng(params, chances))
    xy = camera.project(xyz)
    frames = camera.expose(scene.film(xyz, xy, balls))
    return Recording(f"clip_{number:04d}.mp4", encode(frames, params.camera), xy)


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
