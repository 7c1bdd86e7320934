"""Blobs of change against a still background."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from worlds import ball_film

from physpipe.baselines.background import median_blobs, subtracted_blobs
from physpipe.baselines.blobs import Found
from physpipe.baselines.zoo import BaselineParams

RADIUS_PX = 4.0
FRAMES = 38
ANGLE = 0.14 * np.arange(FRAMES)
PATH = np.stack([42 + 32 * np.cos(ANGLE), 27 + 18 * np.sin(ANGLE)], axis=1)
"""Round the frame, not quite once: no pixel is covered for long."""
LEARNING = 5
"""First frames, in which the mixtures may still take the disc for ground."""
FINDERS = {
    "median": median_blobs,
    "knn": partial(subtracted_blobs, model="knn"),
    "mog2": partial(subtracted_blobs, model="mog2"),
}


@pytest.fixture(params=FINDERS)
def find(request: pytest.FixtureRequest, params: BaselineParams) -> Callable[..., list[Found]]:
    return partial(FINDERS[request.param], params=params.background)


def first(found: list[Found]) -> np.ndarray:
    """(T, 2) the heaviest of every frame, NaN where there is none."""
    return np.array([each.xy[0] if len(each.xy) else [np.nan, np.nan] for each in found])


def test_a_disc_on_a_still_ground_is_found(find) -> None:
    frames = ball_film(PATH[:, None], RADIUS_PX, seed=1, pattern=0)
    apart = np.linalg.norm(first(find(frames, None)) - PATH, axis=1)
    assert np.median(apart[LEARNING:]) < 0.3  # pixels
    assert apart[LEARNING:].max() < 0.5  # pixels: the ground is not even, so the edge's threshold wanders


def test_nothing_is_found_in_ignored_pixels(find) -> None:
    frames = ball_film(PATH[:, None], RADIUS_PX, seed=1, pattern=0)
    ignore = np.zeros(frames.shape[:3], bool)
    ignore[8, :, : round(PATH[8, 0])] = True
    ignore[9] = True
    there, here = first(find(frames, ignore)), first(find(frames, None))
    assert there[8, 0] >= round(PATH[8, 0])
    assert np.isnan(there[9]).all()
    np.testing.assert_array_equal(np.delete(there, [8, 9], axis=0), np.delete(here, [8, 9], axis=0))


def test_a_change_of_the_light_is_nothing(params: BaselineParams) -> None:
    frames = np.repeat(ball_film(PATH[:1, None], RADIUS_PX, seed=1, pattern=0), 12, axis=0)
    brighter = frames + np.arange(0, 60, 5, dtype=np.uint8)[:, None, None, None]
    brighter = np.where(brighter < frames, 255, brighter)
    assert not [each for each in median_blobs(brighter, None, params.background) if len(each.xy)]
