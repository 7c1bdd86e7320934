"""Source pixels <-> clip pixels: edges onto edges, there and back."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physpipe.core.geometry import Geometry

sides = st.floats(1, 4000)


@given(st.floats(0, 4000), st.floats(0, 4000), sides, sides, st.integers(8, 512), st.integers(8, 512))
def test_there_and_back_is_where_it_started(
    left: float, top: float, crop_width: float, crop_height: float, width: int, height: int
) -> None:
    geometry = Geometry(left, top, crop_width, crop_height, width, height)
    xy = np.random.default_rng(0).uniform(-100, 5000, (3, 4, 2))
    np.testing.assert_allclose(geometry.to_source(geometry.to_clip(xy)), xy, atol=1e-6)  # source pixels


def test_the_corners_of_the_box_are_the_corners_of_the_clip() -> None:
    geometry = Geometry(left=24, top=8, crop_width=144, crop_height=100, width=128, height=64)
    np.testing.assert_allclose(geometry.to_clip([[23.5, 7.5], [167.5, 107.5]]), [[-0.5, -0.5], [127.5, 63.5]])
    np.testing.assert_allclose(geometry.scale, [128 / 144, 0.64])


def test_no_crop_and_no_resize_change_nothing() -> None:
    np.testing.assert_allclose(Geometry(0, 0, 40, 24, 40, 24).to_clip([3.25, 7.5]), [3.25, 7.5])


@pytest.mark.parametrize(("width", "height"), [(40, 24), (13, 31), (80, 60)])
def test_a_spot_lies_where_the_area_resize_puts_it(width: int, height: int) -> None:
    xs, ys = np.meshgrid(np.arange(120), np.arange(90))
    spot = np.array([71.3, 38.6])
    source = np.exp(-((xs - spot[0]) ** 2 + (ys - spot[1]) ** 2) / (2 * 9.0**2))
    geometry = Geometry(10, 6, 100, 80, width, height)
    clip = cv2.resize(source[6:86, 10:110], (width, height), interpolation=cv2.INTER_AREA)
    weights = clip / clip.sum()
    centre = np.array([(weights.sum(axis=0) * np.arange(width)).sum(), (weights.sum(axis=1) * np.arange(height)).sum()])
    np.testing.assert_allclose(geometry.to_source(centre), spot, atol=0.1)  # source pixels; the tails are cut off
