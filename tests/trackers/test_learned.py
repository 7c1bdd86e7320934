"""Facts about reading positions off heat maps, and about masking."""

import math

import numpy as np
import pytest
import torch
import worlds

from physpipe.trackers.learned import LearnedTracker, ReadoutParams, cells, readout
from physpipe.trackers.sequential import MaskParams, SequentialTracker, circles, hidden_by

READOUT = ReadoutParams(window_px=9, batch_frames=5)


def bump(x: float, y: float, height: float = 1.0) -> torch.Tensor:
    """(1, 10, 14) cells of a 40 x 56 frame, a Gaussian of 3 px around (x, y)."""
    ys, xs = 4 * torch.arange(10.0) + 1.5, 4 * torch.arange(14.0) + 1.5
    return height * torch.exp(-((xs - x) ** 2 + (ys[:, None] - y) ** 2) / 18)[None]


def test_a_peak_between_cells_is_read_to_a_tenth_of_a_pixel():
    for x, y in [(20.0, 17.3), (31.7, 9.1), (26.2, 22.9)]:
        heat = bump(x, y)
        xy, score = readout(heat / heat.sum(), stride=4, window_px=12)
        assert xy[0].tolist() == pytest.approx([x, y], abs=0.1)  # pixels
        assert score.item() > 0.99


def test_a_second_peak_outside_the_window_lowers_the_score_and_moves_nothing():
    heat = bump(12, 12) + bump(44, 30, height=0.5)
    xy, score = readout(heat / heat.sum(), stride=4, window_px=12)
    alone, _ = readout(bump(12, 12), stride=4, window_px=12)
    torch.testing.assert_close(xy, alone, atol=0.05, rtol=0)
    assert score.item() == pytest.approx(2 / 3, abs=0.02)


def test_no_score_exceeds_one_however_sums_are_rounded():
    heat = torch.rand(200, 10, 14, generator=torch.Generator().manual_seed(0))
    _, score = readout(heat / heat.sum((1, 2), keepdim=True), stride=4, window_px=80)
    assert score.max() <= 1


def test_a_window_as_large_as_the_frame_is_the_paper_s_mean():
    heat = bump(12, 12) + bump(44, 30)
    xy, score = readout(heat / heat.sum(), stride=4, window_px=80)
    assert xy[0].tolist() == pytest.approx([28, 21], abs=0.1)
    assert score.item() == pytest.approx(1)


class Redness(torch.nn.Module):
    """A detector by hand: the mean of red less blue in each cell."""

    stride = 4

    def forward(self, frames: torch.Tensor) -> torch.Tensor:
        return 6 * torch.nn.functional.avg_pool2d(frames[:, :1] - frames[:, 2:], 4)[:, 0]


class Colourfulness(Redness):
    """As Redness, for red and for blue."""

    def forward(self, frames: torch.Tensor) -> torch.Tensor:
        return 6 * torch.nn.functional.avg_pool2d((frames[:, :1] - frames[:, 2:]).abs(), 4)[:, 0]


def two_balls() -> tuple[np.ndarray, np.ndarray]:
    xy = np.stack([worlds.orbit(12, 0.0), worlds.orbit(12, math.pi)], axis=1)
    return worlds.draw(xy, [worlds.RED, worlds.BLUE], seed=0), xy


def test_frames_in_batches_give_what_frames_alone_give():
    frames, xy = two_balls()
    found = LearnedTracker(Redness(), READOUT).track(frames)
    alone = [LearnedTracker(Redness(), READOUT).track(frames[t : t + 1]).xy[0] for t in range(12)]
    np.testing.assert_allclose(found.xy, alone, atol=1e-4)
    assert np.linalg.norm(found.xy - xy[:, 0], axis=1).max() < 1.5  # pixels, of a 4-px cell


def test_masking_the_first_ball_leaves_the_second():
    frames, xy = two_balls()
    first = LearnedTracker(Redness(), READOUT)
    second = LearnedTracker(Colourfulness(), READOUT)
    found = SequentialTracker([first, second], MaskParams(radius_px=8)).track_all(frames)
    for number in (0, 1):
        assert np.linalg.norm(found[number].xy - xy[:, number], axis=1).max() < 1.5  # pixels


def test_a_circle_covers_its_area_and_a_lost_object_hides_nothing():
    xy = np.array([[27.3, 19.8], [np.nan, np.nan]])
    hidden = circles(xy, radius_px=9, height=40, width=56)
    assert hidden[0].sum() == pytest.approx(math.pi * 81, rel=0.03)
    assert not hidden[1].any()
    assert hidden_by([], MaskParams(radius_px=9), 40, 56) is None


def test_a_cell_is_what_its_middle_pixel_is():
    ignore = np.zeros((1, 42, 57), bool)
    ignore[0, 6, 10] = True  # row 1, column 2 of the 4-px cells
    assert np.argwhere(cells(ignore, 4)[0]).tolist() == [[1, 2]]
    assert cells(ignore, 4).shape == (1, 10, 14)
