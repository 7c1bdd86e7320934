"""The simulated sets of the project's own params.yaml."""

from pathlib import Path

from physpipe.core import params
from physpipe.scenes.presets import PresetsParams, SimulateParams
from physpipe.scenes.world_params import WorldParams

PARAMS = Path(__file__).parents[1] / "params.yaml"


def of_the_project(name: str) -> WorldParams:
    """The simulated set `name` of the project's own params.yaml."""
    presets = params.read("presets", PresetsParams, PARAMS)
    return params.read(f"datasets.{name}.simulate", SimulateParams, PARAMS).world(presets, name)
