"""Facts about moving a position to the middle of the object on which it lies."""

import numpy as np
import pytest
import worlds

from physpipe.trackers.look import RefineParams
from physpipe.trackers.refinement import Searcher, refined

REFINE = RefineParams(
    rounds=3,
    reach_px=12,
    search_px=4,
    extent=1.35,
    least_fit=0.5,
    object_part=0.85,
    ground_part=(1.3, 2.2),
    least_radius_px=1.5,
)
T = 20


def film(radius_px: float = 5.0, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """(T, 60, 90, 3) frames of one disc, and its middles (T, 2)."""
    xy = np.stack([30 + 1.3 * np.arange(T), 25 + 0.7 * np.arange(T)], axis=1)
    return worlds.ball_film(xy[:, None], radius_px, seed), xy


def errors(found: np.ndarray, xy: np.ndarray) -> np.ndarray:
    return np.linalg.norm(found - xy, axis=1)


@pytest.mark.parametrize("radius_px", [3.0, 5.0, 7.5])
@pytest.mark.parametrize("offset", [(2.0, 0.0), (-1.5, 1.5)])
def test_a_constant_offset_from_the_middle_is_removed(radius_px, offset):
    frames, xy = film(radius_px)
    found = refined(frames, xy + np.array(offset), REFINE)
    assert errors(found, xy).max() < 0.5  # pixels, where it was 2
    assert np.linalg.norm((found - xy).mean(axis=0)) < 0.25


def test_positions_that_jump_about_come_to_rest_on_the_middle():
    frames, xy = film()
    shaken = xy + np.random.default_rng(1).uniform(-2, 2, xy.shape)
    assert errors(refined(frames, shaken, REFINE), xy).mean() < 0.2


def test_light_from_one_side_moves_nothing():
    """Half the disc in the shade, as a ball lit from the left: the outline counts, not the brightness."""
    frames, xy = film()
    columns = np.arange(frames.shape[2])
    shade = np.clip(1 - 0.06 * (columns - xy[:, :1] + 5), 0.3, 1)[:, None, :, None]
    disc = np.hypot(columns - xy[:, :1, None], np.arange(frames.shape[1])[:, None] - xy[:, 1:, None]) < 5
    lit = np.where(disc[..., None], frames * shade, frames).astype(np.uint8)
    found = refined(lit, xy + 1.0, REFINE)
    assert np.linalg.norm((found - xy).mean(axis=0)) < 0.4  # pixels


def test_lost_frames_stay_lost_and_the_input_stays_as_it_is():
    frames, xy = film()
    gap = xy.astype(np.float32)
    gap[5:8] = np.nan
    before, untouched = gap.copy(), frames.copy()
    found = refined(frames, gap, REFINE)
    assert np.isnan(found[5:8]).all()
    assert np.isfinite(found[8:]).all()
    np.testing.assert_array_equal(gap, before)
    np.testing.assert_array_equal(frames, untouched)
    assert np.isnan(refined(frames, np.full((T, 2), np.nan), REFINE)).all()


def test_where_nothing_fits_a_position_stays():
    frames, xy = film()
    strict = REFINE.model_copy(update={"least_fit": 1.0})
    np.testing.assert_allclose(refined(frames, xy + 1, strict), xy + 1, atol=1e-4)


def test_at_the_edge_of_the_frame_nothing_breaks():
    frames, _ = film()
    corners = np.tile([[0.0, 0.0], [89.0, 59.0]], (T // 2, 1))
    assert np.isfinite(refined(frames, corners, REFINE)).all()


def test_an_object_is_found_again_by_its_look_and_nothing_where_it_is_not():
    frames, xy = film()
    searcher = Searcher(frames[:10], xy[:10], REFINE)
    found = searcher.near(frames[15], xy[15] + np.array([2.0, -2.0]), 4)
    assert found is not None
    assert np.linalg.norm(found[0] - xy[15]) < 0.5  # pixels
    assert found[1] > 0.8
    assert searcher.near(frames[15], np.array([70.0, 10.0]), 4) is None
