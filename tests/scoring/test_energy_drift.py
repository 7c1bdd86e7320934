"""Facts about the energy of forecasts in simulated worlds."""

import numpy as np
import pytest
from simulated import of_the_project

from physpipe.core.geometry import Geometry
from physpipe.io import clips, forecasts
from physpipe.io.clips import Clip, ClipSet
from physpipe.io.forecasts import ClipForecast
from physpipe.scenes.worlds import record
from physpipe.scoring.energy_drift import Replay, energy_figures, replays

NAME, FIRST, T = "bowls2", 4, 10
STEP = 3  # source frames a clip frame
GEOMETRY = Geometry(24, 8, 144, 120, 128, 100)


@pytest.fixture(scope="module")
def rolled(tmp_path_factory) -> tuple[Replay, np.ndarray]:
    """A clip of two balls, rolled again, and their true places (T, 2, 2) in it, px."""
    params = of_the_project(NAME)
    recording = record(params, NAME, 7)
    moments = np.arange(20, len(recording.xy), STEP, dtype=np.int32)
    times = (moments - moments[0]) / params.camera.fps
    frames = np.zeros((len(moments), 100, 128, 3), np.uint8)
    status = np.full(len(moments), "ok")
    clip = Clip("clip_0007_00", "test", recording.source, GEOMETRY, frames, times, moments, times, status)
    folder = tmp_path_factory.mktemp("film") / NAME
    clips.save(folder, [clip])
    film = ClipSet(folder)
    return replays(params, NAME, film, film.names("test"))["clip_0007_00"], GEOMETRY.to_clip(recording.xy[moments])


def steady(replay: Replay, xy: np.ndarray) -> np.ndarray:
    """True places as in a camera that has stood still since the last seen frame."""
    wobble = replay.world.camera.wobble[replay.moments]
    return xy - (wobble - wobble[FIRST - 1])[:, None] * GEOMETRY.scale


def test_the_truth_keeps_its_energy_exactly_whichever_way_its_objects_are_numbered(rolled) -> None:
    replay, xy = rolled
    for order in ([0, 1], [1, 0]):
        path = ClipForecast(FIRST, steady(replay, xy)[FIRST:, order], None)
        assert replay.drift(path, 2 * T) == pytest.approx(0, abs=2e-3)


def test_half_the_speed_loses_three_quarters_of_the_kinetic_energy(rolled) -> None:
    replay, xy = rolled
    at = FIRST + 2
    slow = steady(replay, xy)
    slow = slow[at] + (slow - slow[at]) / 2
    lost = replay.drift(ClipForecast(FIRST, slow[FIRST:], None), at)
    still = replay.drift(ClipForecast(FIRST, np.repeat(slow[at][None], len(slow), axis=0), None), at)
    assert lost == pytest.approx(0.75 * still, abs=0.02)
    assert still < -0.1


def test_figures_are_means_over_clips_and_unknown_beyond_a_forecasts_end(rolled) -> None:
    replay, xy = rolled
    table = forecasts.rows("clip_0007_00", FIRST, steady(replay, xy)[FIRST : 2 * T + 2])
    figures = energy_figures(table, {"clip_0007_00": replay}, T)
    assert figures["energy_drift_T"] == pytest.approx(0, abs=2e-3)
    assert figures["energy_off_T"] == abs(figures["energy_drift_T"])
    assert np.isnan([figures["energy_drift_2T"], figures["energy_off_2T"]]).all()
    assert np.isnan(list(energy_figures(table, {}, T).values())).all()
