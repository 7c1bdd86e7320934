"""Lucas-Kanade on drawn film."""

import numpy as np
import pytest
from worlds import ball_film

from physpipe.baselines.lucas_kanade import LucasKanade
from physpipe.baselines.zoo import BaselineParams
from physpipe.core.errors import InputError

RADIUS_PX = 5.0
PATH = np.stack([15 + 2.3 * np.arange(24), 20 + 10 * np.sin(0.25 * np.arange(24))], axis=1)


@pytest.fixture
def tracker(params: BaselineParams) -> LucasKanade:
    return LucasKanade(params.lucas_kanade, RADIUS_PX)


def test_a_patterned_disc_is_followed(tracker: LucasKanade) -> None:
    found = tracker.track(ball_film(PATH[:, None], RADIUS_PX, seed=0), PATH[0])
    assert np.linalg.norm(found.xy - PATH, axis=1).max() < 0.5  # pixels
    assert found.score.min() > 0.3


def test_a_still_film_holds_the_start_exactly(tracker: LucasKanade) -> None:
    frames = ball_film(np.repeat(PATH[:1, None], 4, axis=0), RADIUS_PX, seed=0)
    np.testing.assert_allclose(tracker.track(frames, PATH[0]).xy, np.tile(PATH[0], (4, 1)), atol=1e-3)  # pixels


def test_it_is_lost_while_everything_near_is_ignored_and_goes_on_from_there(tracker: LucasKanade) -> None:
    frames = ball_film(np.repeat(PATH[:1, None], 8, axis=0), RADIUS_PX, seed=0)
    ignore = np.zeros(frames.shape[:3], bool)
    ignore[3:5] = True
    found = tracker.track(frames, PATH[0], ignore)
    assert np.flatnonzero(np.isnan(found.xy[:, 0])).tolist() == [4, 5]  # carried on from frames 3 and 4
    assert (found.score[4:6] == 0).all()
    np.testing.assert_allclose(found.xy[6:], np.tile(PATH[0], (2, 1)), atol=1e-3)


@pytest.mark.parametrize(
    ("start", "said"),
    [(None, "needs the object's place"), ([90, 5], "outside the frame of 90 x 60"), ([5, np.nan], "outside the frame")],
)
def test_a_start_that_is_missing_or_outside_is_refused(tracker: LucasKanade, start, said: str) -> None:
    with pytest.raises(InputError, match=said):
        tracker.track(np.zeros((3, 60, 90, 3), np.uint8), None if start is None else np.array(start))
