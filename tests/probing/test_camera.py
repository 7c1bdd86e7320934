"""Shift, brightness and blur of pictures that were shifted, dimmed and blurred by so much."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from worlds import ball_film

from physpipe.probing import camera

H, W = 120, 180


def scene(balls: list[list[float]] | None = None, seed: int = 3) -> NDArray[np.float32]:
    xy = np.array([balls or [[40.0, 60.0]]])
    return camera.grey(ball_film(xy, 8.0, seed, height=H, width=W)[0])


@pytest.mark.parametrize("by", [(3.0, -2.0), (0.4, 0.7), (-12.0, 5.0)])
def test_a_shift_is_found_though_a_ball_moves_by_itself(by: tuple[float, float]) -> None:
    later = camera.moved_back(scene([[90.0, 40.0]]), -np.array(by))
    np.testing.assert_allclose(camera.shift(scene(), later), by, atol=0.25)  # pixels


def test_a_still_camera_is_not_moved_by_balls_noise_or_light() -> None:
    noise = np.random.default_rng(0).normal(0, 3, (H, W)).astype(np.float32)
    later = 0.9 * scene([[100.0, 40.0]]) + noise
    np.testing.assert_allclose(camera.shift(scene(), later), 0, atol=0.05)


def test_nothing_is_made_of_a_picture_without_texture() -> None:
    wall = np.full((H, W), 120, np.float32)
    np.testing.assert_array_equal(camera.shift(wall, wall.copy()), [0, 0])
    ball = wall.copy()
    cv2.circle(ball, (60, 60), 9, 220.0, -1)
    np.testing.assert_allclose(camera.shift(ball, np.roll(ball, 30, axis=1)), 0, atol=0.05)


def test_brightness_is_that_of_most_of_the_picture() -> None:
    assert camera.gain(scene(), 0.8 * scene([[90.0, 40.0]])) == pytest.approx(0.8, abs=0.01)


@pytest.mark.parametrize("sigma", [1.0, 2.0, 3.0])
def test_blur_is_measured_in_pixels(sigma: float) -> None:
    edges = np.kron(np.random.default_rng(1).integers(0, 2, (6, 9)), np.ones((30, 30))).astype(np.float32) * 150 + 50
    assert camera.blur_px(cv2.GaussianBlur(edges, (0, 0), sigma)) == pytest.approx(sigma, rel=0.2)


def test_a_picture_without_edges_has_no_blur() -> None:
    assert np.isnan(camera.blur_px(np.full((H, W), 90, np.float32)))
