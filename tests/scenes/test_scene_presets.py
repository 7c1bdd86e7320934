from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.scenes.presets import PresetsParams, SimulateParams, SizeParams

PARAMS = Path(__file__).parents[2] / "params.yaml"
KEY = "datasets.poolr_sim.simulate"


@pytest.fixture(scope="module")
def presets() -> PresetsParams:
    return read("presets", PresetsParams, PARAMS)


@pytest.fixture(scope="module")
def pool() -> SimulateParams:
    return read(KEY, SimulateParams, PARAMS)


def test_names_are_replaced_by_what_they_name(presets: PresetsParams, pool: SimulateParams) -> None:
    world = pool.world(presets, KEY)
    assert world.look == presets.looks["felt"]
    assert (world.terrain, world.camera.fps) == (presets.terrains["pool"], 30)
    assert world.clips == pool.sizes["default"].clips


def test_size_switches_clips_and_length(presets: PresetsParams, pool: SimulateParams) -> None:
    world = pool.model_copy(update={"size": "paper"}).world(presets, KEY)
    assert SizeParams(clips=world.clips, moving_frames=world.moving_frames) == pool.sizes["paper"]


@pytest.mark.parametrize(
    ("field", "wrong", "right"),
    [("look", "flet", "felt"), ("camera", "nera", "near"), ("size", "papr", "paper"), ("terrain", "poool", "pool")],
)
def test_unknown_name_tells_the_nearest(
    presets: PresetsParams, pool: SimulateParams, field: str, wrong: str, right: str
) -> None:
    with pytest.raises(InputError, match=rf"{KEY}\.{field}: no `{wrong}` \(did you mean `{right}`\?\)"):
        pool.model_copy(update={field: wrong}).world(presets, KEY)


def test_parts_that_do_not_go_together_are_refused(presets: PresetsParams, pool: SimulateParams) -> None:
    crowd = pool.model_copy(update={"balls": pool.balls.model_copy(update={"count": 99})})
    with pytest.raises(InputError, match="99 balls of different colours"):
        crowd.world(presets, KEY)
    huge = pool.balls.model_copy(update={"radius_m": (0.2, 0.3)})
    with pytest.raises(InputError, match=r"balls of 0\.3 m"):
        pool.model_copy(update={"balls": huge, "terrain": "heightr"}).world(presets, KEY)
