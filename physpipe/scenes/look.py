"""Colours and light of a scene."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.scenes.texture import TextureParams


class LookParams(Section):
    """Colours and light of the scene."""

    surface_grey: tuple[float, float]
    """Range of the terrain's brightness, 0 to 255, drawn for each clip."""
    tint: float = Field(ge=0)
    """Largest deviation of one colour channel from that grey, in grey levels."""
    dye: tuple[float, float, float]
    """Red, green and blue of the terrain, relative to that; three ones leave it grey."""
    mottle: float = Field(ge=0, lt=1)
    """Standard deviation of the surface's patchiness, relative to its brightness."""
    mottle_px: int = Field(ge=1)
    """Width of one patch, in source pixels."""
    texture: TextureParams | None
    """Finer structure of the terrain's surface; None for a smooth one."""
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
