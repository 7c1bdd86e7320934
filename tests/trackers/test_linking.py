"""Facts about tracks from detections."""

import numpy as np
import pytest

from physpipe.trackers.linking import LinkParams, link
from physpipe.trackers.track import Track

LINKS = LinkParams(
    gate_px=6,
    apart_px=2,
    memory_frames=4,
    least_share=0.3,
    doubt_px=3,
    still_px=2,
    search_px=5,
    look_frames=10,
    speed_frames=2,
)
T = 30


def nowhere(track: Track, frame: int) -> None:
    return None


def straight(start: tuple[float, float], step: tuple[float, float]) -> np.ndarray:
    """(T, 2) pixels."""
    return np.array(start, float) + np.arange(T)[:, None] * np.array(step)


def detections(*paths: np.ndarray, seed: int = 0) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Places in a random order in every frame, NaN ones left out, and scores that fall with the path's number."""
    rng = np.random.default_rng(seed)
    places, scores = [], []
    for frame in range(T):
        order = [k for k in rng.permutation(len(paths)) if np.isfinite(paths[k][frame]).all()]
        places.append(np.array([paths[k][frame] for k in order]).reshape(-1, 2))
        scores.append(np.array([0.9 - 0.2 * k for k in order]))
    return places, scores


def test_two_paths_in_any_order_are_two_tracks_the_surer_first():
    paths = straight((5, 5), (1, 0.5)), straight((50, 35), (-1, 0))
    found = link(*detections(*paths), LINKS, nowhere)
    assert len(found) == 2
    for track, path in zip(found, paths, strict=True):
        np.testing.assert_allclose(track.xy, path, atol=1e-5)
        assert not track.ambiguous.any()


def test_paths_that_cross_go_on_as_they_went():
    paths = straight((5, 20), (1.5, 0)), straight((27, 4), (0, 1.2))  # within 3 px of each other at frames 13 to 15
    found = link(*detections(*paths), LINKS, nowhere)
    for track, path in zip(found, paths, strict=True):
        np.testing.assert_allclose(track.xy, path, atol=1e-5)
    assert found[0].ambiguous.any()
    assert set(np.flatnonzero(found[0].ambiguous)) <= set(range(11, 18))


def test_a_gap_is_bridged_by_a_straight_line_and_one_too_long_ends_the_track():
    path = straight((5, 5), (1, 0.5))
    short, long = path.copy(), path.copy()
    short[10:14] = long[10:20] = np.nan
    bridged = link(*detections(short), LINKS, nowhere)[0]
    np.testing.assert_allclose(bridged.xy, path, atol=1e-5)
    assert (bridged.score[10:14] == 0).all()
    parts = link(*detections(long), LINKS, nowhere)
    assert [np.isfinite(part.xy[:, 0]).sum() for part in parts] == [10, 10]


def test_an_object_may_come_late_and_leave_early():
    path = straight((5, 5), (1, 0.5))
    path[:6] = path[22:] = np.nan
    track = link(*detections(path), LINKS, nowhere)[0]
    np.testing.assert_allclose(track.xy, path, atol=1e-5)


def test_what_shows_too_briefly_is_dropped():
    brief = straight((50, 5), (0, 0))
    brief[5:] = np.nan
    assert len(link(*detections(straight((5, 5), (1, 0)), brief), LINKS, nowhere)) == 1


def test_two_tracks_do_not_settle_on_one_object():
    """While the second hides for some frames the first one's place fits both looks; it stays the first one's."""
    first, second = straight((5, 20), (1, 0)), straight((35, 22), (-1, 0))
    seen = second.copy()
    seen[12:18] = np.nan

    def at_the_first(track: Track, frame: int) -> tuple[np.ndarray, float]:
        return first[frame], 0.9

    found = link(*detections(first, seen), LINKS.model_copy(update={"memory_frames": 12}), at_the_first)
    for track, path in zip(found, (first, second), strict=True):
        np.testing.assert_allclose(track.xy, path, atol=1e-5)  # the second by a straight line over the gap


def test_a_track_that_lost_sight_goes_on_as_the_one_that_began_in_its_place():
    path = straight((5, 5), (1, 0.5))
    path[15:] += 25  # a jump beyond the gate, by which another track begins

    def by_look(track: Track, frame: int) -> tuple[np.ndarray, float] | None:
        return (path[frame], 0.9) if frame > 20 else None

    found = link(*detections(path), LINKS.model_copy(update={"memory_frames": 10}), by_look)
    assert len(found) == 1
    np.testing.assert_allclose(found[0].xy, path, atol=1e-5)
    assert found[0].ambiguous[15]


def test_how_well_a_look_fits_makes_no_track_surer():
    """A mark on the ground that is seen now and then is found again by its look in every frame, and fits perfectly."""
    ball, mark = straight((5, 5), (1, 0.5)), straight((50, 35), (-0.5, 0))
    mark[1::2] = np.nan
    places, scores = detections(ball, mark)
    found = link(places, [each / 3 for each in scores], LINKS, lambda track, frame: (track.expected(frame, 2), 1.0))
    np.testing.assert_allclose(found[0].xy, ball, atol=1e-5)
    assert found[1].score[1::2].min() == 1


def test_what_never_moves_comes_last_however_sure():
    rng = np.random.default_rng(0)
    wobbling = straight((50, 5), (0, 0)) + rng.uniform(-1.5, 1.5, (T, 2))
    places, scores = detections(wobbling, straight((5, 5), (0.5, 0)))
    moving, still = link(places, scores, LINKS, nowhere)
    assert still.score.sum() > moving.score.sum()
    assert (moving.still, still.still) == (False, True)
    np.testing.assert_allclose(still.xy, wobbling, atol=1e-5)


def test_nothing_detected_is_no_track():
    assert link([np.empty((0, 2))] * T, [np.empty(0)] * T, LINKS, nowhere) == []


def test_a_jump_beyond_the_gate_starts_another_track():
    path = straight((5, 5), (0.5, 0))
    path[15:] += 20
    assert len(link(*detections(path), LINKS, nowhere)) == 2


@pytest.mark.parametrize("alike", [True, False])
def test_objects_that_touch_and_look_like_one_are_sought_apart_and_are_ambiguous(alike):
    """One detection between two objects while they are near; sought by their look each is found where it is."""
    first, second = straight((5, 20), (1, 0)), straight((45, 24), (-1, 0))
    near = np.linalg.norm(first - second, axis=1) < 8
    seen = first.copy(), second.copy()
    seen[0][near] = (first[near] + second[near]) / 2
    seen[1][near] = np.nan
    truth = {0: first, 1: second}

    def by_look(track: Track, frame: int) -> tuple[np.ndarray, float] | None:
        expected = track.expected(frame, 2)
        nearest = min(truth, key=lambda k: np.linalg.norm(truth[k][frame] - expected))
        return (truth[nearest][frame], 0.5) if alike else None

    found = link(*detections(*seen), LINKS.model_copy(update={"memory_frames": 12}), by_look)
    assert len(found) == 2
    assert found[0].ambiguous[near].all()
    assert not found[0].ambiguous[: np.flatnonzero(near)[0] - 3].any()
    if alike:
        errors = [
            np.linalg.norm(track.xy - path, axis=1).max() for track, path in zip(found, truth.values(), strict=True)
        ]
        assert max(errors) < 0.01  # pixels
