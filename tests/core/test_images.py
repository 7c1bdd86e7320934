"""Frames keep their places and span 0 to 1."""

import numpy as np

from physpipe.core.images import as_images


def test_channels_come_before_rows_and_white_is_one():
    frames = np.zeros((2, 5, 7, 3), np.uint8)
    frames[1, 4, 6] = (255, 51, 0)
    images = as_images(frames).cpu()
    assert images.shape == (2, 3, 5, 7)
    np.testing.assert_allclose(images[1, :, 4, 6], [1, 0.2, 0], atol=1e-6)
    assert images[0].abs().max() == 0
