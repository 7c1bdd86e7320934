"""Motion is found where it is, in spite of noise, drifting light and a wobbling camera; without motion, none is."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from physpipe.ingest.motion import TrimParams, motion, moving_span

Roll = Callable[..., NDArray[np.uint8]]
NUISANCES = {
    "none": {},
    "noise": {"noise": 6.0},
    "drift": {"drift": 0.15, "noise": 1.0},
    "wobble": {"wobble": 2.0, "noise": 1.0},
    "all": {"noise": 3.0, "drift": 0.15, "wobble": 2.0},
}


@pytest.fixture
def params(trim: dict[str, Any]) -> TrimParams:
    return TrimParams(**trim)


@pytest.mark.parametrize("nuisance", NUISANCES)
@pytest.mark.parametrize("speed", [0.7, 1.5])
def test_the_span_is_that_of_the_motion_within_two_frames(
    roll: Roll, params: TrimParams, nuisance: str, speed: float
) -> None:
    span = moving_span(roll(start=15, stop=45, speed=speed, **NUISANCES[nuisance]), params)
    assert span is not None
    assert span[0] == pytest.approx(15, abs=2)
    assert span[1] == pytest.approx(45, abs=2)


@pytest.mark.parametrize("nuisance", NUISANCES)
@pytest.mark.parametrize("radius", [0.0, 4.0])
def test_nothing_that_stands_still_moves(roll: Roll, params: TrimParams, nuisance: str, radius: float) -> None:
    assert moving_span(roll(speed=0, radius=radius, **NUISANCES[nuisance]), params) is None


@pytest.mark.parametrize("nuisance", NUISANCES)
def test_what_moves_from_first_to_last_is_kept_whole(roll: Roll, params: TrimParams, nuisance: str) -> None:
    span = moving_span(roll(count=50, start=0, stop=50, **NUISANCES[nuisance]), params)
    assert span is not None
    assert span[0] <= params.lag  # frames; the first and last pairs span fewer frames than `lag`
    assert span[1] >= 49 - params.lag


def test_a_swing_that_never_leaves_its_blocks_is_motion_throughout(roll: Roll, params: TrimParams) -> None:
    there = roll(count=12, start=0, stop=12, speed=0.7)
    swing = np.concatenate([there, there[::-1]] * 5).astype(float)
    noisy = np.clip(swing + np.random.default_rng(0).normal(0, 3, swing.shape), 0, 255).round().astype(np.uint8)
    span = moving_span(noisy, params)
    assert span is not None
    assert span[0] <= 3
    assert span[1] >= len(noisy) - 4


def test_a_flash_shorter_than_min_moving_is_no_motion(roll: Roll, params: TrimParams) -> None:
    frames = roll(speed=0, noise=2.0)
    frames[30, 20:40, 20:40] = 255
    short = TrimParams(**{**params.model_dump(), "lag": 1})
    assert moving_span(frames, short) is None


def test_film_backwards_has_the_span_backwards(roll: Roll, params: TrimParams) -> None:
    frames = roll(start=20, stop=40, noise=2.0)
    span, backwards = moving_span(frames, params), moving_span(frames[::-1], params)
    assert span is not None
    assert backwards is not None
    assert np.add(span, backwards[::-1]) == pytest.approx(59, abs=1)


def test_identical_and_single_frames_score_zero(roll: Roll, params: TrimParams) -> None:
    for count in (1, 2, 9):
        frames = np.repeat(roll(count=1), count, axis=0)
        assert np.abs(motion(frames, params)).max() < 1e-3
        assert moving_span(frames, params) is None


def test_light_alone_scores_less_than_noise(roll: Roll, params: TrimParams) -> None:
    lit = motion(roll(speed=0, drift=0.15), params)
    noisy = motion(roll(speed=0, noise=3.0), params)
    assert lit.max() < noisy.max() < params.threshold
