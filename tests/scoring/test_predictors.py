import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from physpipe.core.ball import BallParams
from physpipe.core.geometry import Geometry
from physpipe.io import clips, forecasts, tracks
from physpipe.io.clips import Clip, ClipSet
from physpipe.scoring.predictors import EvaluatePredictorsParams, calibration, score_predictors

T, LENGTH, FIRST = 5, 13, 2
PARAMS = EvaluatePredictorsParams(collision_radii=2.0, bootstrap_resamples=200)
BALL = BallParams(ball_radius_px=5.0)


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


def scored(film, table, truth, horizon=T, objects: int = 1, simulated=None):
    tables = {"tracks": {"persistence": forecast_table(still, objects=objects), "net": table}}
    return score_predictors(film, truth, tables, horizon, PARAMS, BALL, simulated)


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
    """The clips end at frame 12; one object has no collisions; nothing but a covariance tells of likelihood."""
    figures, _ = scored(film, forecast_table(lambda truth: truth), truth_table())
    known = {name for name, value in figures["tracks"]["net"].items() if not np.isnan(value)}
    at = {f"error_{at}_px{end}" for at in ("10", "T", "2T") for end in ("", "_low", "_high")}
    assert known == {*at, "ade_px", "fde_px", "skill_T", "skill_2T", "clips", "frames_to_radius", "within_radius"}


def test_errors_at_fixed_frames_are_those_of_the_frame_whatever_t_is(film):
    figures, _ = scored(film, forecast_table(still), truth_table(), horizon=4)
    rest = figures["tracks"]["net"]
    assert rest["error_10_px"] == rest["error_10_px_low"] == pytest.approx(18)
    assert rest["error_T_px"] == pytest.approx(6)
    assert np.isnan(rest["error_20_px"])


def test_a_forecast_that_ends_early_knows_nothing_of_later_frames(film):
    """An interpolation predictor's last frame is the last one learned, here 7: T is reached, 2 T is not."""
    table = forecast_table(lambda truth: truth, cov=np.eye(2))
    net = scored(film, table[table["frame"] <= 7], truth_table())[0]["tracks"]["net"]
    later = [name for name in net if "2T" in name or "4T" in name or name.startswith("error_10_px")]
    assert len(later) > 20
    assert all(np.isnan(net[name]) for name in later)
    assert (net["error_T_px"], net["coverage_90_T"], net["clips"]) == (0, 1, 3)


def test_likelihood_and_coverage_of_a_probabilistic_forecast(film):
    figures, _ = scored(film, forecast_table(lambda truth: truth, cov=np.eye(2)), truth_table())
    net = figures["tracks"]["net"]
    for suffix in ("", "_2T"):
        assert net[f"nll_nats{suffix}"] == pytest.approx(np.log(2 * np.pi))
        assert net[f"nll_bits{suffix}"] == pytest.approx(np.log2(2 * np.pi))
        assert net[f"perplexity{suffix}"] == pytest.approx(2 * np.pi)
    assert net["energy_score_T_px"] == pytest.approx(np.sqrt(np.pi / 2) * (1 - np.sqrt(0.5)))
    assert net["coverage_90"] == 1


def test_coverage_is_told_for_each_level_at_t_and_at_2t(film):
    """Off by 2 px with a standard deviation of 1 px at T, of 10 px at 2 T: 1 - exp(-2) = 86 % lies nearer at T."""
    std = np.where(np.arange(FIRST, LENGTH) < 2 * T, 1.0, 10.0)[:, None, None, None]
    table = forecast_table(lambda truth: truth + np.array([2.0, 0.0]), cov=std**2 * np.eye(2))
    net = scored(film, table, truth_table())[0]["tracks"]["net"]
    assert [net[f"coverage_{level}_T"] for level in (50, 90, 95)] == [0, 1, 1]
    assert [net[f"coverage_{level}_2T"] for level in (50, 90, 95)] == [1, 1, 1]
    assert net["nll_nats"] == pytest.approx(np.log(2 * np.pi) + 2, abs=1e-5)
    assert net["nll_nats_2T"] == pytest.approx(np.log(2 * np.pi * 100) + 0.02, abs=1e-5)
    assert net["energy_score_2T_px"] > net["energy_score_T_px"]


def test_a_forecast_that_is_sure_and_wrong_is_infinitely_perplexed(film):
    table = forecast_table(lambda truth: truth + 50, cov=0.01 * np.eye(2))
    assert scored(film, table, truth_table())[0]["tracks"]["net"]["perplexity"] == np.inf


def test_frames_to_a_radius_are_the_median_over_objects(film):
    """Standing still costs 2 px a frame from frame 2 on, so 5 px are exceeded at frame 4."""
    net = scored(film, forecast_table(still), truth_table())[0]["tracks"]["net"]
    assert (net["frames_to_radius"], net["within_radius"]) == (4, 0)
    mixed = forecast_table(lambda truth: still(truth) if truth[0, 0, 0] > 10 else truth)  # clip c2 alone stands still
    net = scored(film, mixed, truth_table())[0]["tracks"]["net"]
    assert (net["frames_to_radius"], net["within_radius"]) == (np.inf, pytest.approx(2 / 3))


def meeting(count: int = 3) -> tuple[pd.DataFrame, list[NDArray[np.float64]]]:
    """Truth of test clips with two objects: nearer than two radii (10 px) from frame 4, 8, never; as a table and px."""
    tables, clips = [], []
    for number, frame in enumerate([4, 8, LENGTH][:count]):
        xy = truth_of(number, objects=2)
        xy[frame:, 1, 1] = 9.0
        clips.append(xy)
        tables.append(tracks.rows(f"c{number}", np.arange(LENGTH) / 80, xy, np.ones((LENGTH, 2)), "reference"))
    return pd.concat(tables), clips


def test_errors_before_and_after_the_first_collision_are_told_apart(film):
    """Off by 1, 2, 3 px in the three clips; at T = 5 one pair has met, at 2 T two have."""
    truth, clips = meeting()
    rows = [forecasts.rows(f"c{i}", FIRST, xy[FIRST:] + np.array([i + 1.0, 0.0])) for i, xy in enumerate(clips)]
    net = scored(film, pd.concat(rows), truth, objects=2)[0]["tracks"]["net"]
    assert net["error_T_px_after_collision"] == pytest.approx(1)
    assert net["error_T_px_before_collision"] == pytest.approx(2.5)
    assert net["error_2T_px_after_collision"] == pytest.approx(1.5)
    assert net["error_2T_px_after_collision_high"] == pytest.approx(2)  # both draws the second clip
    assert net["error_2T_px_before_collision"] == pytest.approx(3)


def test_without_collisions_there_is_nothing_after_one(film):
    net = scored(film, forecast_table(still, objects=2), truth_table(objects=2), objects=2)[0]["tracks"]["net"]
    assert net["error_T_px_before_collision"] == net["error_T_px"]
    assert np.isnan(net["error_T_px_after_collision"])


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
