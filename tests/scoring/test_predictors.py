import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from physpipe.core.geometry import Geometry
from physpipe.io import clips, forecasts, tracks
from physpipe.io.clips import Clip, ClipSet
from physpipe.scoring.predictors import EvaluatePredictorsParams, calibration, score_predictors

T, LENGTH, FIRST = 5, 13, 2
PARAMS = EvaluatePredictorsParams(bootstrap_resamples=200)


def truth_of(number: int, objects: int = 1) -> NDArray[np.float64]:
    """(LENGTH, K, 2) px: objects 30 px apart that move by 2 px a frame to the right."""
    t = np.arange(LENGTH)[:, None, None]
    return t * np.array([2.0, 0.0]) + np.array([5.0 * number, 0.0]) + 30 * np.arange(objects)[:, None] * [0.0, 1.0]


@pytest.fixture
def film(tmp_path) -> ClipSet:
    """Three test clips and a training clip."""
    made = []
    for number, split in enumerate(["test", "test", "test", "train"]):
        times = np.arange(LENGTH) / 80
        numbers = np.arange(LENGTH, dtype=np.int32)
        frames = np.zeros((LENGTH, 8, 12, 3), np.uint8)
        geometry = Geometry(0, 0, 12, 8, 12, 8)
        made.append(Clip(f"c{number}", split, "f", geometry, frames, times, numbers, times, np.full(LENGTH, "ok")))
    clips.save(tmp_path / "set", made)
    return ClipSet(tmp_path / "set")


def truth_table(objects: int = 1, count: int = 4) -> pd.DataFrame:
    times, score = np.arange(LENGTH) / 80, np.ones((LENGTH, objects))
    every = [tracks.rows(f"c{i}", times, truth_of(i, objects), score, "reference") for i in range(count)]
    return pd.concat([tracks.empty(), *every])


def forecast_table(positions, cov=None, objects: int = 1) -> pd.DataFrame:
    """Forecasts of the test clips; `positions(truth)` (N, K, 2) from the true ones."""
    parts = []
    for number in range(3):
        mean = positions(truth_of(number, objects)[FIRST:])
        spread = None if cov is None else np.broadcast_to(cov, (*mean.shape[:2], 2, 2))
        parts.append(forecasts.rows(f"c{number}", FIRST, mean, spread))
    return pd.concat(parts)


def still(truth):
    """Stays where it was at frame FIRST - 1."""
    return np.repeat(truth[:1] - [2.0, 0.0], len(truth), axis=0)


def scored(film, table, truth, horizon=T, objects: int = 1):
    tables = {"tracks": {"persistence": forecast_table(still, objects=objects), "net": table}}
    return score_predictors(film, truth, tables, horizon, PARAMS, exact=True)


def test_the_forecaster_that_knows_scores_zero(film):
    figures, horizons = scored(film, forecast_table(lambda truth: truth), truth_table())
    net = figures["tracks"]["net"]
    zeros = ["error_T_px", "error_2T_px", "error_T_px_low", "error_T_px_high", "ade_px", "fde_px"]
    assert [net[name] for name in zeros] == [0] * len(zeros)
    assert (net["skill_T"], net["skill_2T"], net["clips"]) == (1, 1, 3)
    assert (horizons.loc[horizons["predictor"] == "net", "error_px"] == 0).all()


def test_errors_by_hand(film):
    """3-4-5: off by 5 px at every frame; standing still since frame 1 costs 2 px a frame."""
    figures, horizons = scored(film, forecast_table(lambda truth: truth + np.array([3.0, 4.0])), truth_table())
    net, rest = figures["tracks"]["net"], figures["tracks"]["persistence"]
    assert net["error_T_px"] == net["ade_px"] == net["error_T_px_low"] == pytest.approx(5, abs=1e-5)
    assert (rest["error_T_px"], rest["error_2T_px"]) == (pytest.approx(8), pytest.approx(18))  # frames 5 and 10
    assert net["skill_T"] == pytest.approx(1 - 5 / 8, abs=1e-6)
    assert net["skill_2T"] == pytest.approx(1 - 5 / 18, abs=1e-6)
    assert rest["ade_px"] == pytest.approx((2 + 4 + 6 + 8) / 4)  # frames 2 to 5
    curve = horizons[horizons["predictor"] == "persistence"].set_index("frame")["error_px"]
    assert curve[7] == pytest.approx(12)
    assert horizons["frame"].dtype == int
    assert list(horizons.columns) == ["supervision", "predictor", "frame", "error_px"]


def test_what_no_clip_reaches_or_no_predictor_says_is_nan(film):
    figures, _ = scored(film, forecast_table(lambda truth: truth), truth_table())
    net = figures["tracks"]["net"]
    unknown = ["error_4T_px", "error_4T_px_low", "nll_nats", "nll_bits", "coverage_90"]
    assert all(np.isnan(net[name]) for name in unknown)


def test_likelihood_and_coverage_of_a_probabilistic_forecast(film):
    figures, _ = scored(film, forecast_table(lambda truth: truth, cov=np.eye(2)), truth_table())
    net = figures["tracks"]["net"]
    assert net["nll_nats"] == pytest.approx(np.log(2 * np.pi))
    assert net["nll_bits"] == pytest.approx(np.log2(2 * np.pi))
    assert net["coverage_90"] == 1


def test_objects_numbered_otherwise_are_matched_but_a_later_swap_is_an_error(film):
    truth = truth_table(objects=2)
    renumbered = forecast_table(lambda xy: xy[:, ::-1], objects=2)
    figures, _ = scored(film, renumbered, truth, objects=2)
    assert figures["tracks"]["net"]["error_T_px"] == 0

    def swapping(xy):
        late = (np.arange(len(xy)) + FIRST >= T)[:, None, None]
        return np.where(late, xy[:, ::-1], xy)

    figures, _ = scored(film, forecast_table(swapping, objects=2), truth, objects=2)
    assert figures["tracks"]["net"]["error_T_px"] == pytest.approx(30)


def test_without_truth_everything_is_nan_and_no_clip_counts(film):
    figures, horizons = scored(film, forecast_table(lambda truth: truth), tracks.empty())
    assert figures["calibration"] == {}
    net = figures["tracks"]["net"]
    assert net.pop("clips") == 0
    assert all(np.isnan(value) for value in net.values())
    assert horizons.empty


def test_training_clips_never_count(film):
    wrong = pd.concat([forecast_table(lambda xy: xy), forecasts.rows("c3", FIRST, truth_of(3)[FIRST:] + 50)])
    assert scored(film, wrong, truth_table())[0]["tracks"]["net"]["error_T_px"] == 0


def test_calibration_fits_ten_true_positions():
    """x = 2 t + 0.1 t^2 in clip 0 alone: the line through 0..9 misses it, the parabola does not."""
    t = np.arange(LENGTH)
    xy = np.stack([2 * t + 0.1 * t**2, 0 * t], axis=1)[:, None]
    table = tracks.rows("c0", t / 80, xy, np.ones((LENGTH, 1)), "reference")
    figures = calibration(table, horizon=6)
    line = np.polyfit(t[:10], xy[:10, 0, 0], 1)
    assert figures["linear_T_px"] == pytest.approx(abs(np.polyval(line, 6) - xy[6, 0, 0]), abs=1e-4)
    assert figures["quadratic_2T_px"] == pytest.approx(0, abs=1e-4)
