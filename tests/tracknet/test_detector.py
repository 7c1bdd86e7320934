"""Facts about the detector's geometry."""

import pytest
import torch

from physpipe.tracknet.detector import Detector, DetectorParams


@pytest.fixture(params=[2, 4])
def detector(request):
    torch.manual_seed(0)
    return Detector(DetectorParams(width=4, layers=1, stride=request.param)).eval()


def test_one_score_per_cell_on_a_frame_that_is_not_square(detector):
    assert detector(torch.rand(3, 3, 40, 56)).shape == (3, 40 // detector.stride, 56 // detector.stride)


def test_an_odd_frame_loses_its_last_part_cell(detector):
    assert detector(torch.rand(1, 3, 41, 58)).shape == (1, 41 // detector.stride, 58 // detector.stride)


def test_a_shift_by_a_cell_shifts_the_scores_by_a_cell(detector):
    torch.manual_seed(1)
    frames = torch.rand(1, 3, 64, 80)
    shifted = frames.roll(detector.stride, -1)
    margin = 24 // detector.stride  # the reach of all layers, away from the frame's edge
    inside = detector(frames)[:, margin:-margin, margin : -margin - 1]
    moved = detector(shifted)[:, margin:-margin, margin + 1 : -margin]
    torch.testing.assert_close(inside, moved, rtol=1e-4, atol=1e-5)


def test_mirroring_the_kernels_mirrors_the_scores(detector):
    """So a cell stands at the centre of its own pixels: a cell off by half a pixel would break the mirror."""
    torch.manual_seed(2)
    frames = torch.rand(1, 3, 40, 56)
    mirror = Detector(DetectorParams(width=4, layers=1, stride=detector.stride)).eval()
    mirror.load_state_dict(
        {name: value.flip(-1) if value.ndim == 4 else value for name, value in detector.state_dict().items()}
    )
    torch.testing.assert_close(mirror(frames.flip(-1)).flip(-1), detector(frames), rtol=1e-4, atol=1e-5)
