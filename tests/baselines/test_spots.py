"""trackpy told the diameter."""

import sys

import numpy as np
import pytest
from worlds import ball_film

from physpipe.baselines.spots import odd_diameter_px, spots
from physpipe.baselines.zoo import BaselineParams
from physpipe.core.errors import InputError

RADIUS_PX = 5.0
PATH = np.stack(
    [np.stack([20 + 2.0 * np.arange(6), 0 * np.arange(6) + 20], axis=1), np.full((6, 2), [60.0, 40.0])], axis=1
)


@pytest.mark.parametrize(("radius_px", "diameter_px"), [(5.0, 11), (3.3, 7), (7.0, 15), (4.9, 9), (3.9, 7)])
def test_the_diameter_is_the_nearest_odd_number(radius_px: float, diameter_px: int) -> None:
    assert odd_diameter_px(radius_px) == diameter_px


def test_moving_and_resting_discs_of_either_colour_are_found(params: BaselineParams) -> None:
    pytest.importorskip("trackpy")
    found = spots(ball_film(PATH, RADIUS_PX, seed=4), None, params.trackpy, 11)
    for each, truth in zip(found, PATH, strict=True):
        apart = np.linalg.norm(each.xy[:2, None] - truth, axis=2)
        assert sorted(apart.argmin(axis=1)) == [0, 1]
        assert apart.min(axis=1).max() < 0.7  # pixels: the pattern is not even
        assert (np.diff(each.share) <= 0).all()


def test_ignored_pixels_hold_no_spot(params: BaselineParams) -> None:
    pytest.importorskip("trackpy")
    frames = ball_film(PATH[:1], RADIUS_PX, seed=4)
    ignore = np.zeros(frames.shape[:3], bool)
    ignore[:, :, 45:] = True
    (found,) = spots(frames, ignore, params.trackpy, 11)
    assert np.linalg.norm(found.xy[0] - PATH[0, 0]) < 0.7
    assert found.xy[:, 0].max() < 45


def test_without_the_package_it_says_what_to_install(params: BaselineParams, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trackpy", None)
    with pytest.raises(InputError, match="pip install trackpy"):
        spots(np.zeros((1, 20, 30, 3), np.uint8), None, params.trackpy, 11)
