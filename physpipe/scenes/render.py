"""The picture before the camera spoils it: a lit terrain from straight above, with balls on it.

Drawn analytically: the terrain once a clip, then only a small patch a ball and frame.
"""

from collections.abc import Iterator
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.scenes.balls import Ball, Smear, draw_ball, draw_shadow
from physpipe.scenes.film import Camera, Image
from physpipe.scenes.look import Light, LookParams
from physpipe.scenes.terrain import Terrain
from physpipe.scenes.texture import TextureParams, draw_texture

SUPERSAMPLE = 2  # the terrain is drawn this much finer, against jagged rims and contours


class Scene:
    """A terrain with its light, ready to be filmed by one camera."""

    def __init__(
        self,
        params: LookParams,
        terrain: Terrain,
        camera: Camera,
        rng: np.random.Generator,
        surface_rng: np.random.Generator,
    ):
        self.params, self.camera = params, camera
        self.light = Light.sample(params, rng)
        self.background = draw_terrain(params, terrain, camera, self.light, surface_rng)  # (H, W, 3) without wobble

    def film(
        self,
        xyz_m: NDArray[np.float64],
        xy_px: NDArray[np.float64],
        balls: list[Ball],
    ) -> Iterator[Image]:
        """Pictures (H, W, 3), 0 to 255, of the K balls at `xyz_m` (F, K, 3), seen at `xy_px` (F, K, 2)."""
        view = self.camera.params
        size, radii = (view.width, view.height), [ball.radius_m * view.pixels_per_metre for ball in balls]
        way = view.exposure * np.gradient(xy_px, axis=0)
        smears = [Smear(xy_px[:, k], way[:, k], view.shutter_moments, size) for k in range(len(balls))]
        shadows = [draw_shadow(smears[k], radii[k], self.light, self.params) for k in range(len(balls))]
        lit = [draw_ball(smears[k], radii[k], balls[k].rgb, self.light, self.params) for k in range(len(balls))]
        upwards = np.argsort(xyz_m[..., 2], axis=1)  # the higher ball hides the lower
        for frame, (dx, dy) in enumerate(self.camera.wobble.tolist()):
            shift = np.array([[1, 0, dx], [0, 1, dy]])
            picture = cast(Image, cv2.warpAffine(self.background, shift, size, borderMode=cv2.BORDER_REPLICATE))
            for layer in [*shadows, *(lit[k] for k in upwards[frame])]:
                layer.paint(picture, frame)
            yield picture


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
    tone = (rng.uniform(*params.surface_grey) + rng.uniform(-params.tint, params.tint, 3)) * params.dye
    picture = cv2.resize(shade.astype(np.float32), (width, height), interpolation=cv2.INTER_AREA)
    coloured = (picture * _mottle(width, height, params, rng))[..., None] * tone.astype(np.float32)
    return coloured if params.texture is None else coloured * _woven(params.texture, camera, rng)


def _woven(params: TextureParams, camera: Camera, rng: np.random.Generator) -> Image:
    """(H, W, 3) texture that keeps its place on the terrain wherever the camera stands."""
    size = camera.params.width, camera.params.height
    dx, dy = camera.centre - (np.array(size) - 1) / 2
    shift = np.array([[1, 0, dx], [0, 1, dy]])
    return cast(Image, cv2.warpAffine(draw_texture(params, size, rng), shift, size, borderMode=cv2.BORDER_REFLECT))


def _mottle(width: int, height: int, params: LookParams, rng: np.random.Generator) -> Image:
    """(H, W) patchiness around 1."""
    rows, columns = height // params.mottle_px + 2, width // params.mottle_px + 2
    coarse = rng.normal(1, params.mottle, (rows, columns)).astype(np.float32)
    return cast(Image, cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC))
