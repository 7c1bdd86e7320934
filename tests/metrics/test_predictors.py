import numpy as np
import pytest

from physpipe.metrics import predictors as metrics

ORIGIN = np.zeros((1, 1, 2))


def test_objects_are_paired_by_least_total_distance():
    found = np.array([[10.0, 0.0], [0.0, 0.0], [50.0, 50.0]])
    truth = np.array([[1.0, 0.0], [9.0, 0.0]])
    forecasts, objects = metrics.pairing(found, truth)
    assert dict(zip(objects.tolist(), forecasts.tolist(), strict=True)) == {0: 1, 1: 0}


def test_an_invisible_object_takes_what_is_left():
    found = np.array([[10.0, 0.0], [0.0, 0.0]])
    forecasts, objects = metrics.pairing(found, np.array([[np.nan, np.nan], [9.0, 0.0]]))
    assert dict(zip(objects.tolist(), forecasts.tolist(), strict=True)) == {0: 1, 1: 0}


def test_mahalanobis_counts_standard_deviations_along_the_axes():
    cov = np.array([[4.0, 0.0], [0.0, 9.0]])[None, None]
    truth = np.array([[[2.0, 6.0]]])  # one and two standard deviations
    np.testing.assert_allclose(metrics.squared_mahalanobis(ORIGIN, cov, truth), [[5.0]])


def test_nll_of_a_standard_gaussian_by_hand():
    cov = np.eye(2)[None, None]
    np.testing.assert_allclose(metrics.gaussian_nll(ORIGIN, cov, ORIGIN), np.log(2 * np.pi))
    np.testing.assert_allclose(metrics.gaussian_nll(ORIGIN, 4 * cov, ORIGIN), np.log(2 * np.pi) + np.log(4))


def test_a_calibrated_gaussian_covers_what_it_says():
    generator = np.random.default_rng(0)
    cov = np.array([[5.0, 2.0], [2.0, 3.0]])
    truth = generator.multivariate_normal([0, 0], cov, size=(5000, 1))
    inside = metrics.covered(np.zeros_like(truth), np.broadcast_to(cov, (5000, 1, 2, 2)), truth, 0.9)
    assert inside.mean() == pytest.approx(0.9, abs=0.015)  # 3 standard errors


def test_unknown_truth_is_neither_inside_nor_outside():
    cov = np.eye(2)[None, None]
    assert np.isnan(metrics.covered(ORIGIN, cov, ORIGIN * np.nan, 0.9)).all()


def test_a_parabola_is_exact_in_free_fall_and_a_line_is_not():
    t = np.arange(30.0)
    xy = np.stack([3 * t, 10 + t + 0.1 * t**2], axis=1)[:, None]
    np.testing.assert_allclose(metrics.polynomial_errors(xy, 2, 10, [20, 29]), 0, atol=1e-6)
    line = np.polyfit(t[:10], xy[:10, 0, 1], 1)
    expected = abs(np.polyval(line, 20) - xy[20, 0, 1])
    errors = metrics.polynomial_errors(xy, 1, 10, [20, 30])
    np.testing.assert_allclose(errors[0], expected)
    assert np.isnan(errors[1]).all()  # frame 30 is past the end
