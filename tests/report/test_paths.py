"""Paths are drawn through the tables' positions, and from the last seen frame to the one asked for."""

from dataclasses import replace

import numpy as np
import pytest

from physpipe.report import colours
from physpipe.report.brushes import CHI2_90, DASH_PX
from physpipe.report.overlays import Marks, marks_of
from physpipe.report.paths import background, draw_paths

H, W, T, SEEN = 50, 70, 24, 4
UPSCALE = 4
BLACK = np.zeros((H, W, 3), np.uint8)


@pytest.fixture
def marks() -> Marks:
    """An object that goes straight on along y = 12, forecast to turn away downwards."""
    t = np.arange(T)
    truth = np.stack([6 + 2.0 * t, np.full(T, 12.0)], axis=1)[:, None]
    forecast = truth + np.stack([np.zeros(T), 0.06 * np.maximum(t - SEEN, 0) ** 2], axis=1)[:, None] + [0, 4]
    forecast[: SEEN + 1] = np.nan
    return Marks(truth, truth, forecast, np.full((T, 1, 2, 2), np.nan))


def places(picture: np.ndarray, colour: str) -> np.ndarray:
    """(N, 2) clip pixels of all that is in `colour`, within 60 grey levels."""
    y, x = np.nonzero((np.abs(picture.astype(int) - colours.rgb(colour)) < 60).all(axis=2))
    return (np.stack([x, y], axis=1) + 0.5) / UPSCALE - 0.5


def apart(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(N,) distance of each point to the nearest of the others."""
    return np.linalg.norm(points[:, None] - others, axis=-1).min(axis=1)


def along(path: np.ndarray) -> np.ndarray:
    """(N, 2) many points of the line through `path`."""
    t = np.linspace(0, len(path) - 1, 2000)
    return np.stack([np.interp(t, np.arange(len(path)), path[:, axis]) for axis in (0, 1)], axis=1)


@pytest.mark.parametrize("last", [12, 20])
def test_the_forecast_passes_through_the_tables_positions(marks, last):
    drawn = places(draw_paths(BLACK, marks, last, [], UPSCALE), colours.FORECAST)
    path = np.concatenate([marks.track[SEEN, :], marks.forecast[SEEN + 1 : last + 1, 0]])
    assert apart(drawn, along(path)).max() < 0.75  # clip px: half the pen's width, and the chord of a dash
    assert apart(path, drawn).max() < 1.2 * DASH_PX / UPSCALE  # no farther than a gap between dashes
    assert drawn[:, 0].max() == pytest.approx(path[-1, 0], abs=1.2 * DASH_PX / UPSCALE)


def test_the_true_path_runs_from_the_last_seen_frame_to_the_last(marks):
    drawn = places(draw_paths(BLACK, marks, 15, [], UPSCALE), colours.TRUTH)
    path = marks.truth[SEEN:16, 0]
    assert apart(path[2:], drawn).max() < 0.5  # clip px; the first lie under the dot where it was last seen
    assert apart(drawn, along(path)).max() < 0.75


@pytest.mark.parametrize("t", [10, 20])
def test_dots_stand_at_their_frames_and_only_there(marks, t):
    with_dot, without = (
        draw_paths(BLACK, replace(marks, truth=marks.truth[:, :0]), 20, at, UPSCALE) for at in ([t], [])
    )
    y, x = np.nonzero((with_dot != without).any(axis=2))
    middle = (np.array([x.min() + x.max(), y.min() + y.max()]) / 2 + 0.5) / UPSCALE - 0.5
    np.testing.assert_allclose(middle, marks.forecast[t, 0], atol=0.5)  # clip px
    assert np.ptp(x) / UPSCALE < 4.5  # clip px


def test_ellipses_reach_as_far_as_the_covariance_says(marks):
    unsure = replace(marks, covariance=np.broadcast_to(np.diag([9.0, 4.0]), (T, 1, 2, 2)))
    with_one, without = (draw_paths(BLACK, each, 12, [12], UPSCALE) for each in (unsure, marks))
    y, x = np.nonzero((with_one != without).any(axis=2))
    assert np.ptp(x) / UPSCALE == pytest.approx(2 * 3 * CHI2_90**0.5, abs=1.0)  # clip px
    assert np.ptp(y) / UPSCALE == pytest.approx(2 * 2 * CHI2_90**0.5, abs=1.0)
    assert (draw_paths(BLACK, unsure, 12, [], UPSCALE) == draw_paths(BLACK, marks, 12, [], UPSCALE)).all()


def test_without_a_forecast_the_true_path_remains(marks):
    bare = replace(marks, forecast=np.full_like(marks.forecast, np.nan))
    drawn = draw_paths(BLACK, bare, 15, [10], UPSCALE)
    assert len(places(drawn, colours.FORECAST)) == 0
    assert apart(marks.truth[:16, 0], places(drawn, colours.TRUTH)).max() < 0.5


def test_a_path_may_leave_the_frame_and_the_clip(marks):
    far = replace(marks, forecast=marks.forecast * 1e4)
    assert draw_paths(BLACK, far, 3 * T, [5, 2 * T], UPSCALE).shape == (H * UPSCALE, W * UPSCALE, 3)


def test_the_background_is_what_stays():
    frames = np.full((9, H, W, 3), 80, np.uint8)
    for t in range(9):
        frames[t, 10:14, 5 * t : 5 * t + 4] = 250
    for count in (5, 9, 50):
        assert (background(frames, count) == 80).all()
    assert (background(frames[:1], 5) == frames[0]).all()


def test_marks_of_a_made_up_set_are_drawn_where_its_table_says(bowls, project):
    world = project.world
    marks = marks_of(bowls, "bowls_003")
    ground = np.zeros((world.height, world.width, 3), np.uint8)
    drawn = places(draw_paths(ground, marks, 10, [], UPSCALE), colours.FORECAST)
    mine = bowls.forecast[(bowls.forecast["clip"] == "bowls_003") & (bowls.forecast["frame"] <= 10)]
    assert apart(mine[["x", "y"]].to_numpy(float), drawn).max() < 1.2 * DASH_PX / UPSCALE
