"""Film a simulated data set: videos as a camera would leave them, and the exact truth beside them."""

from pathlib import Path

from physpipe.core import params
from physpipe.core.command import run
from physpipe.io import recordings
from physpipe.scenes.presets import PresetsParams, SimulateParams
from physpipe.scenes.worlds import simulate


def main(name: str, raw: Path, annotations: Path) -> None:
    chosen = params.read(f"datasets.{name}.simulate", SimulateParams)
    world = chosen.world(params.read("presets", PresetsParams), f"datasets.{name}.simulate")
    recordings.save(raw, annotations, simulate(world, name))


if __name__ == "__main__":
    run(main)
