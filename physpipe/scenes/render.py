"""The picture before the camera spoils it: a lit terrain from straight above, balls and their soft shadows.

Drawn analytically: the terrain once a clip, then only a small patch a ball and frame.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.scenes.film import Camera, Image
from physpipe.scenes.terrain import Terrain

SUPERSAMPLE = 2  # the terrain is drawn this much finer, against jagged rims and contours
HIGHLIGHT = 16  # sharpness of a ball's highlight (Phong's exponent)


class LookParams(Section):
    """Colours and light of the scene."""

    surface_grey: tuple[float, float]
    """Range of the terrain's brightness, 0 to 255, drawn for each clip."""
    tint: float = Field(ge=0)
    """Largest deviation of one colour channel from that grey, in grey levels."""
    mottle: float = Field(ge=0, lt=1)
    """Standard deviation of the surface's patchiness, relative to its brightness."""
    mottle_px: int = Field(ge=1)
    """Width of one patch, in source pixels."""
    contour_m: float = Field(gt=0)
    """Height between two contour rings, in metres."""
    contour_contrast: float = Field(ge=0, lt=1)
    """Relative darkness of a ring: what shows heights on an evenly lit slope."""
    rim: float = Field(ge=0)
    """Width of the rim, in parts of the distance from the middle to the border."""
    rim_brightness: float = Field(ge=0)
    """Brightness of the rim, relative to a terrain that faces the lamp."""
    table_brightness: float = Field(ge=0)
    """Brightness of what lies around the rim, likewise."""
    light_tilt_deg: tuple[float, float]
    """Range of the light's angle from the vertical, in degrees; its compass direction is any."""
    ambient: float = Field(ge=0, le=1)
    """Part of the light that comes from everywhere."""
    gloss: float = Field(ge=0)
    """Brightness of a ball's highlight, in grey levels."""
    shadow: float = Field(ge=0, le=1)
    """How much of the light the middle of a cast shadow loses."""
    shadow_softness: float = Field(gt=0)
    """Width of a shadow's blurred edge, in ball radii."""


@dataclass(frozen=True)
class Light:
    """A far lamp."""

    towards: NDArray[np.float64]
    """(3,) unit vector from the scene to the lamp: x right, y down, z up."""

    @classmethod
    def sample(cls, params: LookParams, rng: np.random.Generator) -> "Light":
        tilt, compass = np.deg2rad(rng.uniform(*params.light_tilt_deg)), rng.uniform(0, 2 * np.pi)
        return cls(np.array([np.sin(tilt) * np.cos(compass), np.sin(tilt) * np.sin(compass), np.cos(tilt)]))


class Set:
    """A terrain with its light, ready to be filmed by one camera."""

    def __init__(self, params: LookParams, terrain: Terrain, camera: Camera, rng: np.random.Generator):
        self.params, self.camera = params, camera
        self.light = Light.sample(params, rng)
        self.background = draw_terrain(params, terrain, camera, self.light, rng)  # (H, W, 3) without wobble

    def film(
        self,
        xyz_m: NDArray[np.float64],
        xy_px: NDArray[np.float64],
        radius_m: float,
        rgb: list[tuple[int, int, int]],
    ) -> Iterator[Image]:
        """Pictures (H, W, 3), 0 to 255, of balls at `xyz_m` (F, K, 3), seen at `xy_px` (F, K, 2)."""
        view = self.camera.params
        size, radius = (view.width, view.height), radius_m * view.pixels_per_metre
        way = view.exposure * np.gradient(xy_px, axis=0)
        smears = [Smear(xy_px[:, k], way[:, k], view.shutter_moments, size) for k in range(len(rgb))]
        shadows = [draw_shadow(smear, radius, self.light, self.params) for smear in smears]
        balls = [
            draw_ball(smear, radius, colour, self.light, self.params) for smear, colour in zip(smears, rgb, strict=True)
        ]
        upwards = np.argsort(xyz_m[..., 2], axis=1)  # the higher ball hides the lower
        for frame, (dx, dy) in enumerate(self.camera.wobble.tolist()):
            shift = np.array([[1, 0, dx], [0, 1, dy]])
            picture = cast(Image, cv2.warpAffine(self.background, shift, size, borderMode=cv2.BORDER_REPLICATE))
            for layer in [*shadows, *(balls[k] for k in upwards[frame])]:
                layer.paint(picture, frame)
            yield picture


@dataclass(frozen=True)
class Patches:
    """A thing smaller than the picture at F moments: picture <- picture * through + light."""

    corner: NDArray[np.intp]
    """(F, 2) column and row of the patch's top-left pixel."""
    through: Image
    """(F, P, P, 1) part of what lies behind that still shows."""
    light: Image
    """(F, P, P, 3) light of its own, 0 to 255."""

    def paint(self, picture: Image, frame: int) -> None:
        """Draws the thing over `picture` in place."""
        x, y = self.corner[frame]
        rows, columns = self.through.shape[1:3]
        under = picture[y : y + rows, x : x + columns]
        under *= self.through[frame]
        under += self.light[frame]


def draw_terrain(params: LookParams, terrain: Terrain, camera: Camera, light: Light, rng: np.random.Generator) -> Image:
    """(H, W, 3), 0 to 255: shading shows the slope, contour rings the height, a bright ring the border."""
    height, width = camera.params.height, camera.params.width
    scale = camera.params.pixels_per_metre
    fine = (np.arange(SUPERSAMPLE) + 0.5) / SUPERSAMPLE - 0.5
    columns, rows = ((np.arange(n)[:, None] + fine).ravel() for n in (width, height))
    x, y = np.meshgrid((columns - camera.centre[0]) / scale, (rows - camera.centre[1]) / scale)
    level, z = terrain.level(x, y), terrain.height(x, y)
    slope_y, slope_x = np.gradient(z, 1 / scale / SUPERSAMPLE)
    facing = (light.towards[2] - slope_x * light.towards[0] - slope_y * light.towards[1]) / np.sqrt(
        1 + slope_x**2 + slope_y**2
    )
    shade = params.ambient + (1 - params.ambient) * np.maximum(facing, 0)
    shade *= 1 - params.contour_contrast * np.cos(np.pi * z / params.contour_m) ** 8
    shade = np.where(level < 1, shade, np.where(level < 1 + params.rim, params.rim_brightness, params.table_brightness))
    tone = rng.uniform(*params.surface_grey) + rng.uniform(-params.tint, params.tint, 3)
    picture = cv2.resize(shade.astype(np.float32), (width, height), interpolation=cv2.INTER_AREA)
    return (picture * _mottle(width, height, params, rng))[..., None] * tone.astype(np.float32)


@dataclass(frozen=True)
class Smear:
    """Where one ball is seen, and how far it goes while the shutter is open, at F moments."""

    xy: NDArray[np.float64]
    """(F, 2) pixels."""
    way: NDArray[np.float64]
    """(F, 2) pixels during one exposure."""
    moments: int
    """How many moments of an exposure are averaged."""
    size: tuple[int, int]
    """Width and height of the picture."""

    def patches(self, reach: float) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
        """Corners (F, 2) of patches that hold all within `reach` pixels of the ball, and x and y of their pixels
        from the ball's centre at each moment, two (F, M, P, P)."""
        half = int(np.ceil(reach + np.abs(self.way).max() / 2))
        corner = np.clip(np.rint(self.xy).astype(np.intp) - half, 0, np.array(self.size) - 2 * half - 1)
        moment = (np.arange(self.moments) + 0.5) / self.moments - 0.5
        centre = (self.xy - corner)[:, None] + self.way[:, None] * moment[:, None]  # (F, M, 2)
        away = np.arange(2 * half + 1) - centre[..., None]  # (F, M, 2, P)
        dx, dy = np.broadcast_arrays(away[:, :, 0, None, :], away[:, :, 1, :, None])
        return corner, dx, dy


def draw_ball(smear: Smear, radius: float, rgb: tuple[int, int, int], light: Light, look: LookParams) -> Patches:
    """A lit sphere of `radius` pixels."""
    corner, dx, dy = smear.patches(radius + 1)
    distance = np.hypot(dx, dy)
    cover = np.clip(radius + 0.5 - distance, 0, 1)
    inward = 1 / np.maximum(distance, radius)
    nx, ny = dx * inward, dy * inward
    nz = np.sqrt(np.maximum(1 - nx**2 - ny**2, 0))
    facing = np.maximum(np.stack([nx, ny, nz], axis=-1) @ light.towards, 0)
    mirrored = np.maximum(2 * facing * nz - light.towards[2], 0)  # towards the camera, straight above
    diffuse = (cover * (look.ambient + (1 - look.ambient) * facing)).mean(axis=1)
    gloss = (cover * mirrored**HIGHLIGHT).mean(axis=1)
    shine = diffuse[..., None] * np.array(rgb) + look.gloss * gloss[..., None]
    return Patches(corner, (1 - cover.mean(axis=1))[..., None].astype(np.float32), shine.astype(np.float32))


def draw_shadow(smear: Smear, radius: float, light: Light, look: LookParams) -> Patches:
    """The soft shadow of a sphere of `radius` pixels that touches the ground below it."""
    soft = look.shadow_softness * radius
    away = -radius * light.towards[:2] / light.towards[2]
    corner, dx, dy = replace(smear, xy=smear.xy + away).patches(radius + soft)
    depth = np.clip((radius + soft / 2 - np.hypot(dx, dy)) / soft, 0, 1)
    dark = look.shadow * (depth**2 * (3 - 2 * depth)).mean(axis=1)[..., None]
    return Patches(corner, (1 - dark).astype(np.float32), np.zeros((*dark.shape[:3], 3), np.float32))


def _mottle(width: int, height: int, params: LookParams, rng: np.random.Generator) -> Image:
    """(H, W) patchiness around 1."""
    rows, columns = height // params.mottle_px + 2, width // params.mottle_px + 2
    coarse = rng.normal(1, params.mottle, (rows, columns)).astype(np.float32)
    return cast(Image, cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC))
