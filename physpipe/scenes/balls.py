"""Balls and their soft shadows as small patches, drawn for all moments of a clip at once."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from physpipe.scenes.film import Image
from physpipe.scenes.look import Light, LookParams

HIGHLIGHT = 16  # sharpness of a ball's highlight (Phong's exponent)


Rgb = tuple[int, int, int]


@dataclass(frozen=True)
class Ball:
    """What a ball is."""

    rgb: Rgb
    """Colour, 0 to 255."""
    radius_m: float
    """Radius in metres."""


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


def draw_ball(smear: Smear, radius: float, rgb: Rgb, light: Light, look: LookParams) -> Patches:
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
