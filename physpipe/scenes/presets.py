"""Simulated data sets as params.yaml names them: each says its own, and by name what it shares with others."""

from typing import TypeVar

from pydantic import Field, ValidationError

from physpipe.core.errors import InputError
from physpipe.core.params import Section, nearest
from physpipe.scenes.balls import Rgb
from physpipe.scenes.film import CameraParams
from physpipe.scenes.look import LookParams
from physpipe.scenes.physics import PhysicsParams
from physpipe.scenes.terrains import AnyTerrainParams
from physpipe.scenes.world_params import BallsParams, WorldParams

Preset = TypeVar("Preset")


class PresetsParams(Section):
    """What simulated data sets share, by kind and name."""

    terrains: dict[str, AnyTerrainParams]
    physics: dict[str, PhysicsParams]
    palettes: dict[str, list[Rgb]]
    """Colours of balls, 0 to 255."""
    looks: dict[str, LookParams]
    cameras: dict[str, CameraParams]


class SizeParams(Section):
    """How much film."""

    clips: int = Field(ge=1)
    """Number of recordings."""
    moving_frames: int = Field(ge=2)
    """Source frames from the release on."""


class SimulateParams(Section):
    """A simulated data set with names in place of what is shared; `world` puts the named things in."""

    size: str
    """Key of `sizes`."""
    sizes: dict[str, SizeParams]
    still_frames: tuple[int, int]
    """As in WorldParams, like `balls`."""
    balls: BallsParams
    terrain: str
    """Key of the presets' `terrains`."""
    physics: str
    """Key of their `physics`."""
    palette: str
    """Key of their `palettes`."""
    look: str
    """Key of their `looks`."""
    camera: str
    """Key of their `cameras`."""

    def world(self, presets: PresetsParams, section: str) -> WorldParams:
        """The world that `section` of params.yaml describes; raises InputError for a name that does not exist, and
        for parts that do not go together."""
        size = _named(self.sizes, self.size, f"{section}.size")
        try:
            return WorldParams(
                clips=size.clips,
                still_frames=self.still_frames,
                moving_frames=size.moving_frames,
                terrain=_named(presets.terrains, self.terrain, f"{section}.terrain"),
                balls=self.balls,
                physics=_named(presets.physics, self.physics, f"{section}.physics"),
                palette=_named(presets.palettes, self.palette, f"{section}.palette"),
                look=_named(presets.looks, self.look, f"{section}.look"),
                camera=_named(presets.cameras, self.camera, f"{section}.camera"),
            )
        except ValidationError as error:
            raise InputError(section, str(error.errors()[0]["msg"]), "correct params.yaml") from None


def _named(known: dict[str, Preset], name: str, key: str) -> Preset:
    if name not in known:
        raise InputError(key, f"no `{name}`{nearest(name, list(known))}", f"use one of {sorted(known)}")
    return known[name]
