"""Connected blobs: exact centres and masses."""

import numpy as np

from physpipe.baselines.blobs import blobs, kept


def strength() -> np.ndarray:
    """A blob of two pixels, of weights 3 and 1; one of four pixels, of weight 2 each; a lone weak pixel."""
    drawn = np.zeros((12, 20))
    drawn[2, 3], drawn[2, 4] = 3, 1
    drawn[7:9, 14:16] = 2
    drawn[11, 0] = 0.4
    return drawn


def test_blobs_are_centres_of_mass_heaviest_first() -> None:
    found = blobs(strength(), 0.5, 1)
    np.testing.assert_allclose(found.xy, [[14.5, 7.5], [3.25, 2]])
    np.testing.assert_allclose(found.share, [8 / 12, 4 / 12])


def test_small_ones_do_not_count_but_for_their_mass() -> None:
    found = blobs(strength(), 0.5, 3)
    np.testing.assert_allclose(found.xy, [[14.5, 7.5]])
    np.testing.assert_allclose(found.share, [8 / 12])


def test_touching_corners_join() -> None:
    assert len(blobs(np.eye(5), 0.5, 1).xy) == 1


def test_nothing_above_the_threshold_gives_nothing() -> None:
    assert blobs(strength(), 3, 1).xy.shape == (0, 2)


def test_what_is_hidden_has_no_strength() -> None:
    hidden = np.zeros((12, 20), bool)
    hidden[7] = True
    np.testing.assert_allclose(blobs(kept(strength(), hidden), 0.5, 1).xy, [[3.25, 2], [14.5, 8]])
