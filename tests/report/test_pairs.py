"""Forecasts are paired with the truth as the scores pair them."""

import numpy as np
import pytest

from physpipe.io import forecasts, tracks
from physpipe.report.pairs import missed
from physpipe.scoring.forecast_errors import forecast_errors

T, K, SEEN = 12, 2, 4


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    """(T, K, 2) px; object 1 is not visible at frame 9."""
    xy = np.random.default_rng(5).uniform(0, 60, (T, K, 2)).astype(np.float32)
    xy[9, 1] = np.nan
    return xy


@pytest.fixture(scope="module")
def found(truth) -> tuple:
    """The pairs, and the forecast table: the objects exchanged and off by (3, 4) px, two frames beyond the clip."""
    ahead = np.pad(np.nan_to_num(truth[SEEN:, ::-1]), ((0, 2), (0, 0), (0, 0))) - np.array([3.0, 4.0])
    table = forecasts.rows("clip", SEEN, ahead, np.broadcast_to(np.eye(2), (*ahead.shape, 2)))
    known = tracks.rows("clip", np.arange(T) / 10, truth, np.ones((T, K)))
    return missed(table, known)["clip"], table


def test_every_object_is_beside_its_own_truth(found):
    pairs, _ = found
    np.testing.assert_allclose(pairs.at(SEEN), [[3, 4], [3, 4]], atol=1e-4)  # px
    assert pairs.error_px(8) == pytest.approx(5, abs=1e-4)
    assert pairs.cov_at(8).shape == (K, 2, 2)


def test_what_is_not_known_is_left_out(found):
    pairs, _ = found
    assert np.isnan(pairs.at(9)).any()
    assert pairs.error_px(9) == pytest.approx(5, abs=1e-4)  # of the object that is visible
    for frame in (SEEN - 1, T):
        assert (len(pairs.at(frame)), len(pairs.cov_at(frame)), pairs.error_px(frame)) == (0, 0, None)


def test_errors_are_those_of_the_scores(found, truth):
    pairs, table = found
    scored = forecast_errors(table, {"clip": truth}, within_px=1.0).groupby("frame")["error_px"].mean()
    for frame in range(SEEN, T):
        assert pairs.error_px(frame) == pytest.approx(scored[frame])


def test_clips_without_truth_are_left_out(found):
    assert missed(found[1], tracks.empty()) == {}
