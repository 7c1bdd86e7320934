"""Trackers that look at nothing."""

import numpy as np
import pytest

from physpipe.baselines.constant import Centre, Persistence
from physpipe.core.errors import InputError

FRAMES = np.zeros((4, 24, 40, 3), np.uint8)


def test_persistence_stays_at_the_start_and_needs_one() -> None:
    found = Persistence().track(FRAMES, np.array([3.25, 7.5]))
    np.testing.assert_array_equal(found.xy, np.tile([3.25, 7.5], (4, 1)))
    with pytest.raises(InputError, match="persistence"):
        Persistence().track(FRAMES)


def test_the_centre_is_as_far_from_the_first_pixel_as_from_the_last() -> None:
    found = Centre().track_all(FRAMES, 2)
    assert len(found) == 2
    for each in found:
        np.testing.assert_array_equal(each.xy, np.tile([19.5, 11.5], (4, 1)))
        assert (each.score == 0).all()
        assert each.xy.dtype == np.float32
