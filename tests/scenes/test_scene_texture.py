import numpy as np
import pytest

from physpipe.scenes.texture import TextureParams, draw_texture

PARAMS = TextureParams(contrast=0.08, colour=0.0, widest_px=16, layers=4, fade=0.8, stretch=1)
SIZE = (180, 140)


def drawn(**changes: float) -> np.ndarray:
    return draw_texture(PARAMS.model_copy(update=changes), SIZE, np.random.default_rng(2))


def roughness(picture: np.ndarray, axis: int) -> float:
    """Mean squared step between neighbours over the variance: about 2 for white noise, small for smooth ones."""
    return float((np.diff(picture[..., 0], axis=axis) ** 2).mean() / picture[..., 0].var())


def test_brightness_is_one_with_the_asked_contrast() -> None:
    picture = drawn()
    assert picture.shape == (140, 180, 3)
    assert picture.mean() == pytest.approx(1, abs=1e-3)
    assert picture.std() == pytest.approx(0.08, rel=1e-3)


def test_channels_are_alike_unless_coloured() -> None:
    np.testing.assert_allclose(np.ptp(drawn(), axis=2), 0, atol=1e-6)
    assert np.ptp(drawn(colour=1), axis=2).mean() > 0.05


def test_more_layers_are_finer() -> None:
    assert roughness(drawn(layers=1), 1) < roughness(drawn(layers=3), 1) / 4


def test_stretch_makes_grain_along_x() -> None:
    assert roughness(drawn(stretch=6), 1) < roughness(drawn(stretch=6), 0) / 3
