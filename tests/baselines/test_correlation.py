"""ZNCC and its peaks."""

import numpy as np
import pytest

from physpipe.baselines.correlation import peaks, zncc

H, W = 30, 44


def texture(seed: int = 0) -> np.ndarray:
    """(H, W, 3) of LAB-like numbers."""
    return np.random.default_rng(seed).normal(50, 12, (H, W, 3)).astype(np.float32)


@pytest.mark.parametrize(("h", "w"), [(5, 9), (6, 8)])
def test_a_patch_correlates_one_with_itself_and_minus_one_with_its_negative(h: int, w: int) -> None:
    frame = texture()
    patch = frame[10 : 10 + h, 20 : 20 + w]
    at = 10 + (h - 1) // 2, 20 + (w - 1) // 2
    response = zncc(frame, patch, flat_lab=1)
    assert response.shape == (H, W)
    assert response[at] == pytest.approx(1, abs=1e-4)
    assert np.unravel_index(response.argmax(), response.shape) == at
    assert zncc(100 - frame, patch, flat_lab=1)[at] == pytest.approx(-1, abs=1e-4)


def test_it_is_the_textbook_formula() -> None:
    frame, patch = texture(), texture(1)[:5, :7]
    window = frame[8:13, 12:19].astype(float)
    a, b = (each - each.mean(axis=(0, 1)) for each in (window, patch.astype(float)))
    expected = (a * b).sum() / np.sqrt((a**2).sum() * (b**2).sum())
    assert zncc(frame, patch, flat_lab=1)[10, 15] == pytest.approx(expected, abs=1e-4)


def test_gain_and_offset_of_brightness_change_nothing() -> None:
    frame = texture()
    patch = frame[3:12, 5:16]
    np.testing.assert_allclose(zncc(0.6 * frame + 17, patch, 1), zncc(frame, patch, 1), atol=1e-4)


def test_flat_parts_and_flat_patches_correlate_with_nothing() -> None:
    frame = texture()
    frame[:, :20] = 40 + 1e-3 * texture(1)[:, :20]
    response = zncc(frame, frame[10:17, 30:37], flat_lab=2)
    assert np.isfinite(response).all()
    assert (response[:, :16] == 0).all()
    assert (zncc(frame, frame[5:12, 3:10], flat_lab=2) == 0).all()


def blob(x: float, y: float) -> np.ndarray:
    """(H, W, 3): a smooth spot of colour at (x, y) on a slope."""
    rows, columns = np.mgrid[:H, :W]
    height = np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 18)
    return (np.stack([60 * height, -30 * height, 45 * height], axis=2) + columns[..., None] * 0.1).astype(np.float32)


@pytest.mark.parametrize(("dx", "dy"), [(2.3, -1.7), (0.5, 0.5), (-3.1, 4.4)])
def test_a_shift_is_found_to_a_tenth_of_a_pixel(dx: float, dy: float) -> None:
    response = zncc(blob(20 + dx, 14 + dy), blob(20, 14)[8:21, 13:28], flat_lab=1)  # the patch's middle is (20, 14)
    where, height = peaks(response, 1, None)
    np.testing.assert_allclose(where[0], [20 + dx, 14 + dy], atol=0.1)  # pixels
    assert height[0] > 0.98


def test_the_highest_peaks_come_first_and_none_where_it_is_forbidden() -> None:
    response = np.zeros((H, W), np.float32)
    response[5, 7], response[20, 30], response[10, 12] = 0.9, 0.8, 0.7
    where, height = peaks(response, 2, None)
    np.testing.assert_array_equal(where, [[7, 5], [30, 20]])
    np.testing.assert_allclose(height, [0.9, 0.8])
    ignore = np.zeros((H, W), bool)
    ignore[5, 7] = True
    np.testing.assert_array_equal(peaks(response, 2, ignore)[0], [[30, 20], [12, 10]])
    assert len(peaks(response, 2, np.ones((H, W), bool))[0]) == 0


def test_the_peak_of_a_parabola_is_exact() -> None:
    rows, columns = np.mgrid[:H, :W]
    response = (1 - 0.01 * (columns - 17.3) ** 2 - 0.02 * (rows - 9.6) ** 2).astype(np.float32)
    np.testing.assert_allclose(peaks(response, 1, None)[0], [[17.3, 9.6]], atol=1e-4)  # pixels
