"""A start that can be used."""

import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.trackers.base import required

FRAMES = np.zeros((2, 24, 40, 3), np.uint8)


@pytest.mark.parametrize("start", [(-0.5, -0.5), (39.5, 23.5), (12, 7.25)])
def test_a_start_on_any_pixel_s_area_is_given_back(start) -> None:
    np.testing.assert_array_equal(required(np.array(start), FRAMES, "any"), start)


@pytest.mark.parametrize("start", [(-0.51, 3), (39.51, 3), (3, 23.51), (3, -0.51), (np.nan, 3)])
def test_one_outside_the_frame_is_refused_with_its_place(start) -> None:
    with pytest.raises(InputError, match=r"tracker `any`: starts at x = .* outside the frame of 40 x 24 pixels"):
        required(np.array(start), FRAMES, "any")


def test_none_is_refused_with_the_mend() -> None:
    with pytest.raises(InputError, match=r"tracker `any`: needs .* To mend: annotate the clip or drop the tracker"):
        required(None, FRAMES, "any")
