"""Finds become tracks."""

import numpy as np

from physpipe.baselines.blobs import NOTHING, Found
from physpipe.baselines.linking import FinderParams, FinderTracker, link

FRAMES = np.zeros((6, 30, 50, 3), np.uint8)
T = np.arange(6)
LEFT, RIGHT = (np.stack([5 + 4.0 * T, 0 * T + 10], axis=1), np.stack([25 - 4.0 * T, 0 * T + 20], axis=1))


def test_objects_that_pass_each_other_keep_their_number_whatever_comes_first() -> None:
    places = [[a, b] if t % 2 else [b, a] for t, a, b in zip(T, LEFT, RIGHT, strict=True)]
    found = [Found(np.array(each), np.array([0.6, 0.4])) for each in places]
    xy, score = link(found, 2, far_px=60)
    first = int(xy[0, 0, 0] != LEFT[0, 0])
    np.testing.assert_array_equal(xy[:, first], LEFT.astype(np.float32))
    np.testing.assert_array_equal(xy[:, 1 - first], RIGHT.astype(np.float32))
    np.testing.assert_allclose(score.sum(axis=1), 1)


def test_an_object_is_lost_where_too_few_are_found_and_found_again_where_it_was() -> None:
    found = [Found(np.array([a, b]), np.array([0.6, 0.4])) for a, b in zip(LEFT, RIGHT, strict=True)]
    found[0] = Found(LEFT[:1], np.ones(1))
    found[3] = NOTHING
    xy, score = link(found, 2, far_px=60)
    assert np.argwhere(np.isnan(xy[..., 0])).tolist() == [[0, 1], [3, 0], [3, 1]]  # frame, object
    np.testing.assert_array_equal(xy[1], np.stack([LEFT[1], RIGHT[1]]).astype(np.float32))
    assert (score[3] == 0).all()


def test_a_find_much_lighter_than_the_heaviest_is_not_believed() -> None:
    found = [Found(np.array([a, b]), np.array([0.8, 0.2])) for a, b in zip(LEFT, RIGHT, strict=True)]
    for least, lost in ((0.2, False), (0.3, True)):
        tracker = FinderTracker(lambda frames, ignore: found, FinderParams(least_share=least))
        one, other = tracker.track_all(FRAMES, 2)
        np.testing.assert_array_equal(one.xy, LEFT.astype(np.float32))
        assert np.isnan(other.xy).all() == lost
