"""Tracker metrics, against figures worked out by hand."""

import numpy as np
import pytest

from physpipe.metrics.trackers import (
    OtherMotionParams,
    bootstrap_interval,
    delta_avg,
    distance,
    error_figures,
    longest_run,
    match,
    off_track,
    other_motion,
    swapped,
)

T = 20


def two_balls() -> np.ndarray:
    """(T, 2, 2): ball 0 runs right along y = 10, ball 1 left along y = 40; never nearer than 30 px."""
    t = np.arange(T)
    return np.stack([np.stack([10 + 3.0 * t, 10 + 0 * t], 1), np.stack([70 - 3.0 * t, 40 + 0 * t], 1)], axis=1)


def test_distance_is_nan_where_either_side_is() -> None:
    found = np.array([[3.0, 4.0], [np.nan, np.nan], [1, 1]])
    truth = np.array([[0.0, 0.0], [0, 0], [np.nan, np.nan]])
    np.testing.assert_array_equal(distance(found, truth), [5, np.nan, np.nan])


def test_figures_of_four_errors_by_hand() -> None:
    figures = error_figures(np.array([[3.0, 4.0], [3, -4], [-3, 4], [5, 12]]))  # lengths 5, 5, 5, 13
    assert figures["mean_px"] == 7
    assert figures["median_px"] == 5
    assert figures["var_px2"] == 12  # (4 + 4 + 4 + 36) / 4
    assert figures["p99_px"] == pytest.approx(5 + 0.97 * 8)  # linear between the third and the fourth
    assert figures["bias_px"] == pytest.approx(np.hypot(2, 4))


def test_bias_and_jitter_share_out_the_mean_squared_error() -> None:
    offsets = np.random.default_rng(0).normal([1.5, -0.5], [0.3, 2.0], (500, 2))
    figures = error_figures(offsets)
    assert figures["bias_px"] ** 2 + figures["jitter_px"] ** 2 == pytest.approx((offsets**2).sum(axis=1).mean())
    constant = error_figures(np.tile([3.0, -4.0], (9, 1)))
    assert (constant["bias_px"], constant["jitter_px"], constant["var_px2"]) == (5, 0, 0)


def test_nothing_found_has_no_figures() -> None:
    assert all(np.isnan(value) for value in error_figures(np.empty((0, 2))).values())


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_tracks_are_matched_over_the_whole_clip_whatever_their_order(order: list[int]) -> None:
    truth = two_balls()
    found = truth[:, order] + 0.5
    found[3:5] = found[3:5, ::-1]  # a short exchange does not turn the match
    found[9, 0] = np.nan
    matched = match(found, truth)
    assert np.isnan(matched).any(axis=2).sum() == 1
    steady = np.r_[0:3, 5:9, 10:T]
    np.testing.assert_array_equal(matched[steady], truth[steady] + 0.5)


def test_a_ball_without_a_track_is_lost_and_a_spare_track_is_dropped() -> None:
    truth = two_balls()
    matched = match(truth[:, 1:] + 1, truth)
    assert np.isnan(matched[:, 0]).all()
    np.testing.assert_array_equal(matched[:, 1], truth[:, 1] + 1)
    np.testing.assert_array_equal(match(truth, truth[:, 1:]), truth[:, 1:])


def test_a_track_that_is_nearly_always_lost_is_no_match_for_a_near_one() -> None:
    truth = two_balls()[:, :1]
    lost_but_once = np.full((T, 1, 2), np.nan)
    lost_but_once[0] = truth[0]
    near = truth + np.where(np.arange(T) == 7, 5, 1)[:, None, None]
    np.testing.assert_array_equal(match(np.concatenate([lost_but_once, near], axis=1), truth), near)


@pytest.mark.parametrize(
    ("marks", "longest"), [("", 0), ("...", 0), ("##.###.", 3), (".####", 4), ("#", 1), ("##########", 10)]
)
def test_longest_run(marks: str, longest: int) -> None:
    assert longest_run(np.array([mark == "#" for mark in marks], bool)) == longest


def test_off_track_begins_at_so_many_frames_in_a_row_beyond_the_limit() -> None:
    truth = two_balls()[:, 0]

    def off(frames: slice, error: float) -> bool:
        found = truth.copy()
        found[frames] += [error, 0]
        return off_track(found, truth, limit_px=9, frames=10)

    assert off(slice(5, 15), 9.5)
    assert not off(slice(5, 14), 9.5)  # nine frames
    assert not off(slice(0, T), 9.0)  # exactly at the limit is not beyond it
    assert not off(slice(0, T, 2), 50)  # never in a row
    assert off(slice(5, 15), np.nan)  # lost is off track too


def test_frames_without_truth_neither_break_nor_make_a_run() -> None:
    truth = two_balls()[:, 0]
    found = truth + 20
    truth[8:12] = np.nan
    assert off_track(found, truth, limit_px=9, frames=16)
    assert not off_track(found, truth, limit_px=9, frames=17)


def test_delta_avg_by_hand() -> None:
    truth = np.zeros((5, 1, 2))
    found = truth.copy()
    found[:, 0, 0] = [0.4, 0.6, 3, 100, np.nan]  # px of a frame 128 wide: 0.8, 1.2, 6, 200 of 256, lost
    # within 1: 1 of 5; within 2: 2; within 4: 2; within 8: 3; within 16: 3
    assert delta_avg(found, truth, 128, 64) == pytest.approx((1 + 2 + 2 + 3 + 3) / 25)
    found[:, 0] = found[:, 0, ::-1]  # the same errors downwards, in a frame half as high: 1.6, 2.4, 12
    assert delta_avg(found, truth, 128, 64) == pytest.approx((0 + 1 + 2 + 2 + 3) / 25)
    assert delta_avg(truth, truth, 128, 64) == 1
    assert np.isnan(delta_avg(found, np.full_like(truth, np.nan), 128, 64))


def test_a_swap_is_a_lasting_exchange_of_balls_that_are_apart() -> None:
    truth = two_balls()

    def swap(frames: slice) -> bool:
        found = truth + 0.3
        found[frames] = found[frames, ::-1]
        return swapped(found, truth, diameter_px=10, frames=5)

    assert swap(slice(7, 12))
    assert not swap(slice(7, 11))
    assert not swap(slice(0, 0))
    assert not swapped(truth[:, :1] + 9, truth[:, :1], diameter_px=10, frames=5)  # one ball has none to swap with


def test_no_swap_is_judged_while_the_balls_touch_or_one_is_lost() -> None:
    truth = two_balls()
    found = truth[:, ::-1].copy()
    assert swapped(found, truth, diameter_px=10, frames=5)
    assert not swapped(found, truth, diameter_px=100, frames=5)
    found[:, 1] = np.nan
    assert not swapped(found, truth, diameter_px=10, frames=5)


def test_the_bootstrap_interval_has_the_width_of_the_standard_error() -> None:
    clip_means = np.random.default_rng(1).normal(5, 2, 200)
    counts = np.full(200, 60.0)
    low, high = bootstrap_interval(clip_means * counts, counts, resamples=4000)
    expected = 1.96 * clip_means.std() / np.sqrt(200)
    assert low < clip_means.mean() < high
    assert (high - low) / 2 == pytest.approx(expected, rel=0.1)
    assert bootstrap_interval(clip_means * counts, counts, 4000) == (low, high)


def test_a_longer_clip_weighs_more_and_no_clip_gives_no_interval() -> None:
    low, high = bootstrap_interval(np.array([10.0, 10.0]), np.array([10.0, 10.0]), 100)
    assert low == high == 1
    assert bootstrap_interval(np.array([0.0, 900.0]), np.array([0.0, 100.0]), 100) == (9, 9)
    assert np.isnan(bootstrap_interval(np.empty(0), np.empty(0), 100)).all()


H, W, RADIUS_PX = 48, 80, 5.0
OTHER = OtherMotionParams(threshold_grey=25, narrowest_px=5, share=0.01, disc_radii=2)


def film(hand: slice = slice(0), gain: float = 1.0, shake_px: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Frames with a ball and thin dark lines, and the ball's (T, 1, 2) positions; a hand comes in during `hand`."""
    rows, columns = np.mgrid[:H, :W]
    truth = np.stack([10 + 3.0 * np.arange(T), 12 + 0.0 * np.arange(T)], axis=1)[:, None]
    frames = []
    for t in range(T):
        moved = columns + (shake_px if t % 2 else 0)
        frame = np.where(moved % 20 < 2, 60.0, 160.0)
        if t in range(T)[hand]:
            frame[36:, 30:50] = 40
        frame[np.hypot(columns - truth[t, 0, 0], rows - truth[t, 0, 1]) <= RADIUS_PX] = 20
        frames.append(frame * gain ** (t / T))
    return np.repeat(np.stack(frames)[..., None], 3, axis=3).astype(np.uint8), truth


def test_a_hand_is_other_motion_and_the_ball_is_not() -> None:
    np.testing.assert_array_equal(
        other_motion(*film(hand=slice(6, 11)), RADIUS_PX, OTHER), (np.arange(T) >= 6) & (np.arange(T) < 11)
    )


def test_drifting_light_and_a_shaken_camera_are_no_other_motion() -> None:
    assert not other_motion(*film(gain=0.8), RADIUS_PX, OTHER).any()
    assert not other_motion(*film(shake_px=2), RADIUS_PX, OTHER).any()


def test_a_ball_at_rest_for_most_of_a_clip_leaves_no_ghost() -> None:
    frames, truth = film()
    order = np.r_[0:3, [3] * (T - 3)]
    assert not other_motion(frames[order], truth[order], RADIUS_PX, OTHER).any()
    nowhere = np.full_like(truth, np.nan)
    assert other_motion(frames, nowhere, RADIUS_PX, OTHER).all()  # a ball that nobody reported is other motion
