"""Crop and resize: which box, and that areas are averaged."""

from pathlib import Path

import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.ingest.framing import CropParams, geometry, reframed

PATH = Path("a.mp4")


def test_without_a_crop_it_is_the_largest_centred_square() -> None:
    assert geometry(PATH, (100, 161, 3), None, 32) == Geometry(30, 0, 100, 100, 32, 32)
    assert geometry(PATH, (161, 100, 3), None, 32) == Geometry(0, 30, 100, 100, 32, 32)


def test_a_crop_may_touch_the_frames_edge_but_not_leave_it() -> None:
    assert geometry(PATH, (100, 160), CropParams(left=60, top=20, width=100, height=80), 32).left == 60
    for box in ({"left": 61, "top": 20}, {"left": 60, "top": 21}):
        with pytest.raises(InputError, match="outside the frame of 160 x 100 px") as caught:
            geometry(PATH, (100, 160), CropParams(**box, width=100, height=80), 32)
        assert caught.value.where == "a.mp4"


def test_a_clips_pixel_is_the_mean_of_its_area() -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (60, 90, 3)).astype(np.uint8)
    found = reframed(pixels, Geometry(10, 4, 64, 48, 16, 16))
    means = pixels[4:52, 10:74].reshape(16, 3, 16, 4, 3).mean(axis=(1, 3))
    assert found.shape == (16, 16, 3)
    assert np.abs(found - means).max() <= 0.5 + 1e-6  # grey levels, rounding


def test_a_spots_centre_goes_where_the_geometry_says() -> None:
    xs, ys = np.meshgrid(np.arange(160), np.arange(120))
    spot = 255 * np.exp(-((xs - 83.4) ** 2 + (ys - 52.7) ** 2) / (2 * 6.0**2))
    where = Geometry(20, 10, 120, 100, 32, 32)
    seen = reframed(np.repeat(spot[..., None], 3, axis=2).astype(np.uint8), where)[..., 0].astype(float)
    xs, ys = np.meshgrid(np.arange(32), np.arange(32))
    centre = np.array([(xs * seen).sum(), (ys * seen).sum()]) / seen.sum()
    np.testing.assert_allclose(centre, where.to_clip([83.4, 52.7]), atol=0.05)  # clip pixels
