"""What holds for every baseline tracker of the zoo, found from the list of its members."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from worlds import ball_film

from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BASELINES, BaselineParams, Finder, Follower, Settings, known_flows
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.io.annotations import Box
from physpipe.trackers.base import Trajectory

PARAMS = Path(__file__).parents[2] / "params.yaml"
RADIUS_PX = 4.0
ANGLE = 0.14 * np.arange(32)
PATHS = np.stack(
    [
        np.stack([42 + 30 * np.cos(ANGLE), 27 + 17 * np.sin(ANGLE)], axis=1),
        np.stack([42 - 30 * np.cos(ANGLE), 27 - 17 * np.sin(ANGLE)], axis=1),
    ],
    axis=1,
)
FILM = ball_film(PATHS, RADIUS_PX, seed=5, pattern=10)
MOVED = (5, 7)
"""Pixels down and right."""
MOVES_WITH_THE_FILM = ["persistence", "lucas_kanade", "median_blob", "lab", "trackpy"]
MAKES_NO_SUCH_PROMISE = {
    "centre": "is the frame's",
    "knn_blob": "replaces samples at random",
    "mog2_blob": "replaces samples at random",
    "farneback_simple": "its pyramid's grid stays with the frame",
    "farneback_blob": "its pyramid's grid stays with the frame",
    "dis_simple": "its grid of patches stays with the frame",
    "dis_blob": "its grid of patches stays with the frame",
    "flow_simple": "as its network does",
    "flow_blob": "as its network does",
}
LOOKS_AT_NOTHING = {"centre", "persistence"}


@pytest.fixture(scope="module")
def settings() -> Settings:
    """The project's own numbers; DIS stands in for a learned flow."""
    params = read("baselines", BaselineParams, PARAMS)
    flows = known_flows(params)
    template = read("ground_truth", TemplateParams, PARAMS)
    return Settings(params, template, RADIUS_PX, flows | {"flow": flows["dis"]})


@pytest.fixture(params=BASELINES)
def name(request: pytest.FixtureRequest) -> str:
    if request.param == "trackpy":
        pytest.importorskip("trackpy")
    return request.param


def tracked(
    name: str,
    settings: Settings,
    frames: NDArray[np.uint8],
    starts: NDArray[np.float64],
    ignore: NDArray[np.bool_] | None = None,
) -> list[Trajectory]:
    """A trajectory for each of the (K, 2) starts."""
    baseline = BASELINES[name]
    if isinstance(baseline, Finder):
        return baseline.build(settings).track_all(frames, len(starts), ignore)
    boxes = [[Box(0, round(x) - 6, round(y) - 6, 13, 13)] for x, y in starts]
    return [
        baseline.build(settings, box).track(frames, start, ignore) for box, start in zip(boxes, starts, strict=True)
    ]


@pytest.mark.parametrize("objects", [1, 2])
def test_every_object_has_a_finite_place_or_is_lost_in_every_frame(name: str, objects: int, settings) -> None:
    film = FILM.copy()
    film.setflags(write=False)  # nothing may be written into the frames
    found = tracked(name, settings, film, PATHS[0, :objects])
    assert len(found) == objects
    for each in found:
        assert each.xy.shape == (len(FILM), 2)
        assert each.score.shape == (len(FILM),)
        assert (each.xy.dtype, each.score.dtype) == (np.float32, np.float32)
        assert not np.isinf(each.xy).any()
        assert (np.isnan(each.xy[:, 0]) == np.isnan(each.xy[:, 1])).all()
        assert ((each.score >= 0) & (each.score <= 1)).all()
        assert (each.score[np.isnan(each.xy[:, 0])] == 0).all()


def test_the_same_film_gives_the_same_tracks(name: str, settings) -> None:
    once, again = (tracked(name, settings, FILM, PATHS[0]) for _ in range(2))
    for one, other in zip(once, again, strict=True):
        np.testing.assert_array_equal(one.xy, other.xy)
        np.testing.assert_array_equal(one.score, other.score)


@pytest.mark.parametrize("name", MOVES_WITH_THE_FILM)
def test_moving_the_film_moves_the_tracks(name: str, settings) -> None:
    if name == "trackpy":
        pytest.importorskip("trackpy")
    moved = np.roll(FILM, MOVED, axis=(1, 2))
    here = tracked(name, settings, FILM, PATHS[0])
    there = tracked(name, settings, moved, PATHS[0] + MOVED[::-1])
    for one, other in zip(here, there, strict=True):
        np.testing.assert_allclose(other.xy - one.xy, np.tile(MOVED[::-1], (len(FILM), 1)), atol=0.05)  # pixels


def test_every_baseline_says_whether_it_moves_with_the_film() -> None:
    assert set(BASELINES) == {*MOVES_WITH_THE_FILM, *MAKES_NO_SUCH_PROMISE}


def test_all_that_look_find_nothing_in_ignored_pixels(name: str, settings) -> None:
    if name in LOOKS_AT_NOTHING:
        pytest.skip("looks at no pixel")
    ignore = np.ones(FILM.shape[:3], bool)
    (found,) = tracked(name, settings, FILM, PATHS[0, :1], ignore)
    known = isinstance(BASELINES[name], Follower)  # a follower knows its start
    assert np.isnan(found.xy[known:]).all()


def test_a_follower_refuses_to_run_without_a_start_or_from_outside(name: str, settings) -> None:
    baseline = BASELINES[name]
    if isinstance(baseline, Finder) or name == "lab":
        pytest.skip("needs no start; boxes stand for it")
    tracker = baseline.build(settings, [])
    for start in (None, np.array([90.0, 10.0]), np.array([10.0, -0.6])):
        with pytest.raises(InputError):
            tracker.track(FILM, start)
