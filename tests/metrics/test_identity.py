"""Figures of identity, against figures worked out by hand and TrackEval's."""

import numpy as np
import pytest

from physpipe.metrics.identity import Tracked, identity_figures, similarity, unflagged_stretches

T, DIAMETER_PX = 20, 10.0
KEYS = ("hota", "idf1", "id_switches", "idf1_unflagged", "flagged")


def two_balls() -> np.ndarray:
    """(T, 2, 2): ball 0 runs right along y = 10, ball 1 left along y = 50; never nearer than 40 px."""
    t = np.arange(T)
    return np.stack([np.stack([10 + 3.0 * t, 10 + 0 * t], 1), np.stack([70 - 3.0 * t, 50 + 0 * t], 1)], axis=1)


def figures(found: np.ndarray, truth: np.ndarray | None = None, flagged: np.ndarray | None = None) -> dict:
    truth = two_balls() if truth is None else truth
    flagged = np.zeros(found.shape[:2], bool) if flagged is None else flagged
    return identity_figures([Tracked(found, truth, flagged)], DIAMETER_PX)


def exchanged(frames: slice) -> np.ndarray:
    found = two_balls()
    found[frames] = found[frames, ::-1]
    return found


def test_similarity_is_a_half_one_diameter_away_and_none_at_two() -> None:
    truth = np.array([[[10.0, 20.0], [60, 20]]])
    found = np.array([[[10.0, 20.0], [10, 30], [10, 40], [25, 20], [np.nan, np.nan]]])
    expected = [[1, 0.5, 0, 0.25, 0], [0, 0, 0, 0, 0]]
    np.testing.assert_allclose(similarity(found, truth, DIAMETER_PX)[0], expected, atol=1e-12)


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_perfect_tracks_whatever_their_numbers(order: list[int]) -> None:
    assert figures(two_balls()[:, order]) == dict(zip(KEYS, (1, 1, 0, 1, 0), strict=True))


def test_a_swap_halfway() -> None:
    found = figures(exchanged(slice(T // 2, None)))
    assert (found["idf1"], found["id_switches"]) == (0.5, 2)
    # every pair of identities shares half its 20 frames: 10 of 20 + 20 - 10, and detection is perfect
    assert found["hota"] == pytest.approx(np.sqrt(1 / 3))
    assert figures(exchanged(slice(5, 10)))["id_switches"] == 4  # there and back


def test_an_object_without_a_track_and_a_track_too_many() -> None:
    one = figures(two_balls()[:, 1:])
    assert one["idf1"] == pytest.approx(2 / 3)  # 20 right of 40 true and 20 found
    assert one["hota"] == pytest.approx(np.sqrt(1 / 2))
    spare = np.concatenate([two_balls(), np.tile([100.0, 30.0], (T, 1, 1))], axis=1)
    three = figures(spare)
    assert three["idf1"] == pytest.approx(0.8)  # 40 right of 40 true and 60 found
    assert three["hota"] == pytest.approx(np.sqrt(2 / 3))
    assert one["id_switches"] == three["id_switches"] == 0
    nothing = figures(np.empty((T, 0, 2)))
    assert (nothing["hota"], nothing["idf1"], nothing["id_switches"]) == (0, 0, 0)


def test_an_offset_costs_nothing_in_identity_until_the_discs_part() -> None:
    for offset, idf1 in ((9.99, 1), (10.01, 0)):
        assert figures(two_balls() + np.array([offset, 0]))["idf1"] == idf1
    # similarity 0.8 passes the thresholds up to 0.8, 16 of 19
    assert figures(two_balls() + np.array([3.999, 0]))["hota"] == pytest.approx(16 / 19)


def test_a_lost_stretch_is_no_switch_and_another_number_after_it_is_one() -> None:
    truth = two_balls()
    holes = truth.copy()
    holes[8:12, 0] = np.nan
    assert figures(holes)["id_switches"] == 0
    assert figures(holes)["idf1"] == pytest.approx(2 * 36 / (40 + 36))
    born = np.concatenate([holes, np.full((T, 1, 2), np.nan)], axis=1)
    born[12:, 2], born[12:, 0] = truth[12:, 0], np.nan
    assert figures(born)["id_switches"] == 1
    assert figures(born)["idf1"] == pytest.approx(2 * (20 + 8) / (40 + 36))


def test_a_swap_within_a_flagged_span_is_forgiven_and_another_is_not() -> None:
    found, flagged = exchanged(slice(10, None)), np.zeros((T, 2), bool)
    flagged[9:11, 0] = True  # one flag is enough: frames 0-8 and 11-19 stand alone
    forgiven = figures(found, flagged=flagged)
    assert (forgiven["idf1"], forgiven["idf1_unflagged"], forgiven["flagged"]) == (0.5, 1, 0.1)
    flagged = np.roll(flagged, -6, axis=0)  # frames 3 and 4: 3 frames right, then 5 and 10 of 15
    elsewhere = figures(found, flagged=flagged)
    assert elsewhere["idf1_unflagged"] == pytest.approx((3 + 10) / 18)
    doubts_all = figures(found, flagged=np.ones((T, 2), bool))
    assert np.isnan(doubts_all["idf1_unflagged"])
    assert doubts_all["flagged"] == 1


@pytest.mark.parametrize(
    ("marks", "stretches"), [("....", [4]), ("#..#.", [2, 1]), ("..##", [2]), ("##", []), ("", [])]
)
def test_stretches_lie_between_flagged_frames(marks: str, stretches: list[int]) -> None:
    flagged = np.array([[mark == "#", False] for mark in marks], bool).reshape(-1, 2)
    clip = Tracked(np.zeros((len(marks), 2, 2)), np.zeros((len(marks), 2, 2)), flagged)
    assert [len(each.truth) for each in unflagged_stretches(clip)] == stretches


def test_frames_in_which_an_object_is_not_visible_are_left_out() -> None:
    truth = two_balls()
    truth[5:9, 1] = np.nan
    assert figures(two_balls(), truth)["idf1"] == 1
    assert all(np.isnan(value) for value in figures(two_balls(), np.full_like(truth, np.nan)).values())
    assert all(np.isnan(value) for value in identity_figures([], DIAMETER_PX).values())


def test_clips_add_up_by_their_frames() -> None:
    short = Tracked(two_balls()[:10], two_balls()[:10], np.zeros((10, 2), bool))
    lost = Tracked(np.full((T, 2, 2), np.nan), two_balls(), np.zeros((T, 2), bool))
    found = identity_figures([short, lost], DIAMETER_PX)
    assert found["idf1"] == pytest.approx(2 * 20 / (60 + 20))
    assert found["hota"] == pytest.approx(np.sqrt(1 / 3))


def wild(seed: int, found_count: int, true_count: int) -> Tracked:
    """Noisy tracks that now and then exchange their objects and lose them, in a frame of 128 x 80 px."""
    draws = np.random.default_rng(seed)
    truth = np.cumsum(draws.normal(0, 2, (60, true_count, 2)), axis=0) + draws.uniform([10, 10], [100, 60])
    found = np.full((60, found_count, 2), np.nan)
    owner = np.arange(found_count)
    for t in range(60):
        owner = draws.permutation(found_count) if draws.random() < 0.08 else owner
        for k, m in enumerate(owner):
            found[t, k] = truth[t, m] + draws.normal(0, 2.5, 2) if m < true_count else draws.uniform([0, 0], [128, 80])
    found[draws.random((60, found_count)) < 0.15] = np.nan
    found[10:13] = np.nan
    return Tracked(found, truth, np.zeros((60, found_count), bool))


def test_it_counts_as_trackeval() -> None:
    """Expected: HOTA, Identity and CLEAR of TrackEval 1.3.0, given the same similarities, sequences combined."""
    found = identity_figures([wild(0, 4, 3), wild(1, 2, 2)], DIAMETER_PX)
    assert found["hota"] == pytest.approx(0.492431702881, abs=1e-9)
    assert found["idf1"] == pytest.approx(0.621993127148, abs=1e-9)
    assert found["id_switches"] == 17
