"""sRGB to CIE LAB against published values."""

import numpy as np
import pytest

from physpipe.core.colour import srgb_to_lab


@pytest.mark.parametrize(
    ("rgb", "lab"),
    [
        ((255, 255, 255), (100, 0, 0)),
        ((0, 0, 0), (0, 0, 0)),
        ((255, 0, 0), (53.24, 80.09, 67.20)),
        ((0, 0, 255), (32.30, 79.19, -107.86)),
    ],
)
def test_primaries_have_their_published_lab(rgb: tuple[int, ...], lab: tuple[float, ...]) -> None:
    found = srgb_to_lab(np.array([[rgb]], np.uint8))
    np.testing.assert_allclose(found[0, 0], lab, atol=0.02)  # LAB units; the published values have two digits
    assert found.dtype == np.float32


def test_greys_have_no_colour_and_grow_lighter() -> None:
    lab = srgb_to_lab(np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1))
    np.testing.assert_allclose(lab[:, 1:], 0, atol=0.01)
    assert (np.diff(lab[:, 0]) > 0).all()


def test_any_shape_is_converted_pixel_by_pixel() -> None:
    film = np.random.default_rng(0).integers(0, 256, (2, 5, 7, 3), dtype=np.uint8)
    np.testing.assert_array_equal(srgb_to_lab(film)[1, 3, 4], srgb_to_lab(film[1, 3, 4]))
    assert srgb_to_lab(film).shape == film.shape
