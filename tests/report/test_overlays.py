"""Marks are drawn where they belong, and only those that there are."""

from dataclasses import replace

import numpy as np
import pytest

from physpipe.report import colours
from physpipe.report.overlays import Marks, draw, marks_of

H, W, T = 30, 44, 6
UPSCALE = 3
BLACK = np.zeros((H, W, 3), np.uint8)


def nothing(K: int = 1) -> Marks:
    return Marks(*(np.full((T, K, *tail), np.nan) for tail in ((2,), (2,), (2,), (2, 2))))


def centre_of(picture: np.ndarray, colour: str) -> np.ndarray:
    """(x, y) in clip pixels of the middle of everything in `colour`, within 40 grey levels."""
    near = (np.abs(picture.astype(int) - colours.rgb(colour)) < 40).all(axis=2)
    y, x = np.nonzero(near)
    return (np.array([(x.min() + x.max()) / 2, (y.min() + y.max()) / 2]) + 0.5) / UPSCALE - 0.5


def at(xy: list[float]) -> np.ndarray:
    return np.broadcast_to(np.array(xy), (T, 1, 2)).copy()


def test_without_marks_a_frame_is_only_enlarged():
    frame = np.full((H, W, 3), 77, np.uint8)
    picture = draw(frame, nothing(), 3, UPSCALE, 4)
    assert picture.shape == (H * UPSCALE, W * UPSCALE, 3)
    assert (picture == 77).all()


@pytest.mark.parametrize("xy", [[12.0, 9.0], [20.5, 17.3]])
def test_ring_and_dot_are_centred_on_their_positions(xy):
    ring = draw(BLACK, replace(nothing(), truth=at(xy)), 3, UPSCALE, 0)
    np.testing.assert_allclose(centre_of(ring, colours.TRUTH), xy, atol=0.5)  # clip pixels
    dot = draw(BLACK, replace(nothing(), track=at(xy)), 3, UPSCALE, 0)
    np.testing.assert_allclose(centre_of(dot, colours.of_object(0)), xy, atol=0.5)


def test_forecast_starts_after_the_last_seen_frame():
    forecast = at([30.0, 20.0])
    forecast[:3] = np.nan
    marks = replace(nothing(), forecast=forecast)
    assert marks.ahead == [3, 4, 5]
    assert (draw(BLACK, marks, 2, UPSCALE, 4) == 0).all()
    np.testing.assert_allclose(centre_of(draw(BLACK, marks, 3, UPSCALE, 4), colours.FORECAST), [30, 20], atol=0.5)


def test_ellipse_reaches_as_far_as_the_covariance_says():
    covariance = np.broadcast_to(np.diag([9.0, 1.0]), (T, 1, 2, 2))
    marks = replace(nothing(), forecast=at([22.0, 15.0]), covariance=covariance)
    y, x = np.nonzero(draw(BLACK, marks, 5, UPSCALE, 0).any(axis=2))
    assert np.ptp(x) / UPSCALE == pytest.approx(2 * 3 * 4.605**0.5, abs=1.0)  # clip pixels


def test_objects_have_their_own_colours():
    track = np.stack([at([10.0, 10.0])[:, 0], at([30.0, 20.0])[:, 0]], axis=1)
    picture = draw(BLACK, replace(nothing(2), track=track), 0, UPSCALE, 3)
    for k, xy in enumerate(([10.0, 10.0], [30.0, 20.0])):
        np.testing.assert_allclose(centre_of(picture, colours.of_object(k)), xy, atol=0.5)


def test_marks_are_those_of_the_tables(bowls, film, project):
    world = project.world
    marks = marks_of(bowls, "bowls_003")
    np.testing.assert_allclose(
        marks.track - marks.truth, np.broadcast_to([world.off_px, 0], marks.truth.shape), atol=1e-4
    )
    assert marks.ahead == list(range(world.seen, world.frames))
    assert np.isfinite(marks.covariance[world.seen :]).all()
    assert marks_of(film, "film_003").truth.shape == (world.frames, 0, 2)  # nobody annotated it
    assert marks_of(bowls, "bowls_000").ahead == []  # a training clip has no forecast
