import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

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


def drawn(count: int) -> tuple[NDArray, NDArray, NDArray]:
    """Means (count, 1, 2), covariances (count, 1, 2, 2), no two alike, and a truth drawn from each."""
    generator = np.random.default_rng(0)
    mean = 50 * generator.random((count, 1, 2))
    root = generator.normal(size=(count, 1, 2, 2)) + 2 * np.eye(2)
    truth = mean + (root @ generator.normal(size=(count, 1, 2, 1)))[..., 0]
    return mean, root @ root.swapaxes(-1, -2), truth


def test_nll_is_scipys():
    mean, cov, truth = drawn(20)
    expected = [-stats.multivariate_normal(mean[i, 0], cov[i, 0]).logpdf(truth[i, 0]) for i in range(20)]
    np.testing.assert_allclose(metrics.gaussian_nll(mean, cov, truth)[:, 0], expected)


@pytest.mark.parametrize("level", [0.5, 0.9, 0.95])
def test_a_calibrated_gaussian_covers_what_it_says(level):
    inside = metrics.covered(*drawn(5000), level)
    assert inside.mean() == pytest.approx(level, abs=3 * np.sqrt(level * (1 - level) / 5000))  # 3 standard errors


def test_a_gaussian_half_as_wide_as_the_truth_covers_less():
    """The ellipse of 90 % of a 2-D Gaussian of half the standard deviation holds 1 - 0.1^(1/4) of it."""
    mean, cov, truth = drawn(5000)
    expected = 1 - 0.1**0.25
    inside = metrics.covered(mean, cov / 4, truth, 0.9).mean()
    assert inside == pytest.approx(expected, abs=3 * np.sqrt(expected * (1 - expected) / 5000))


def test_energy_score_of_a_standard_gaussian_at_its_centre_by_hand():
    """E|X| = sqrt(pi / 2) and E|X - X'| = sqrt(2) E|X|; it scales with the standard deviation."""
    expected = np.sqrt(np.pi / 2) * (1 - np.sqrt(0.5))
    cov = np.eye(2)[None, None]
    np.testing.assert_allclose(metrics.energy_score(ORIGIN, cov, ORIGIN), expected)
    np.testing.assert_allclose(metrics.energy_score(ORIGIN, 9 * cov, ORIGIN), 3 * expected)


def test_energy_score_is_what_samples_say():
    mean, cov, truth = drawn(4)
    found = metrics.energy_score(mean, cov, truth)
    generator = np.random.default_rng(1)
    for i in range(4):
        one, other = generator.multivariate_normal(mean[i, 0], cov[i, 0], size=(2, 200_000))
        samples = np.linalg.norm(one - truth[i, 0], axis=1) - np.linalg.norm(one - other, axis=1) / 2
        assert found[i, 0] == pytest.approx(samples.mean(), abs=4 * samples.std() / np.sqrt(len(samples)))


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1])
def test_energy_score_without_spread_is_the_error(angle):
    """Here the integrand has a kink between two directions: the worst that the sum over directions meets."""
    truth = 200 * np.array([np.cos(angle), np.sin(angle)])[None, None]
    np.testing.assert_allclose(metrics.energy_score(ORIGIN, 1e-8 * np.eye(2)[None, None], truth), 200, rtol=1e-3)


def test_energy_score_is_least_for_the_true_spread():
    mean, cov, truth = drawn(5000)
    scores = [metrics.energy_score(mean, factor * cov, truth).mean() for factor in (0.25, 1, 4)]
    assert scores[1] < min(scores[0], scores[2])


def test_objects_touch_from_the_first_frame_in_which_they_are_near():
    """0 and 1 meet in frame 2 and part again; 2 comes near 0 in frame 3; 3 keeps away."""
    nobody = [90.0, 90.0]
    xy = np.array([
        [[0, 0], [9, 0], [50, 0], nobody],
        [[0, 0], [6, 0], [50, 0], nobody],
        [[0, 0], [5, 0], [9, 0], nobody],
        [[0, 0], [9, 0], [-5, 0], nobody],
    ])  # fmt: skip
    assert metrics.first_touch(xy, within_px=6).tolist() == [2, 2, 2, np.inf]
    assert metrics.first_touch(xy[:2], within_px=6).tolist() == [np.inf] * 4
    xy[2, 1] = np.nan
    assert metrics.first_touch(xy, within_px=6).tolist() == [3, np.inf, 3, np.inf]


def test_a_lone_object_knows_no_collisions():
    assert np.isnan(metrics.first_touch(np.zeros((3, 1, 2)), within_px=6)).all()


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
