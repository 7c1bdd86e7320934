"""How many pixels of the film a metre has."""

from typing import Any

from pydantic import Field

from physpipe.core.params import Section, read, read_value
from physpipe.scenes.presets import PresetsParams, SimulateParams


class ScaleParams(Section):
    """Section `datasets.<name>.scale` of params.yaml."""

    pixels_per_metre: float | None = Field(gt=0)
    """In pixels of the upright source frame, in the plane of the motion; empty: not known."""


def pixels_per_metre(name: str) -> float | None:
    """Of a data set, in pixels of its film: as params.yaml says, or as its simulated camera was; None if unknown.

    Raises InputError for a set without a section.
    """
    section: Any = read_value(f"datasets.{name}")
    if "simulate" in section:
        simulated = read(f"datasets.{name}.simulate", SimulateParams)
        presets = read("presets", PresetsParams)
        return simulated.world(presets, f"datasets.{name}.simulate").camera.pixels_per_metre
    if "scale" in section:
        return read(f"datasets.{name}.scale", ScaleParams).pixels_per_metre
    return None
