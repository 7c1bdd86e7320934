"""Facts about how far the camera moved."""

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.steadying import camera_path, camera_shifts

HEIGHT, WIDTH = 60, 80
SHIFTS = torch.tensor([[0.5, -0.3], [0.3, 0.2], [-0.2, 0.4], [0.0, 0.0]])


def film(gains: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)) -> torch.Tensor:
    """(1, 4, 3, H, W): waves moved by SHIFTS px, under light of those gains."""
    waves = torch.rand(30, 3, generator=torch_generator(0)) * torch.tensor([0.6, 0.6, 6.28])  # rad/px, rad
    y, x = torch.meshgrid(torch.arange(float(HEIGHT)), torch.arange(float(WIDTH)), indexing="ij")
    frames = []
    for (dx, dy), gain in zip(SHIFTS.tolist(), gains, strict=True):
        picture = sum(torch.sin(kx * (x - dx) + ky * (y - dy) + phase) for kx, ky, phase in waves.tolist())
        frames.append(gain * (0.5 + 0.02 * torch.as_tensor(picture)).expand(3, -1, -1))
    return torch.stack(frames)[None]


@pytest.mark.parametrize("gains", [(1.0, 1.0, 1.0, 1.0), (0.9, 1.05, 1.1, 1.0)])
def test_shifts_are_found_whatever_the_light(gains):
    assert (camera_shifts(film(gains))[0] - SHIFTS).abs().max() < 0.01  # px


def test_what_moves_by_itself_has_no_say():
    still = film()
    for number, left in enumerate((20, 24, 28, 32)):
        still[0, number, :, 20:30, left : left + 10] = torch.tensor([1.0, 0.2, 0.0])[:, None, None]
    assert (camera_shifts(still)[0] - SHIFTS).abs().max() < 0.02  # px


def test_the_way_from_the_first_frame_is_the_sum_of_the_shifts():
    assert (camera_path(film((1.0, 1.05, 0.9, 1.0))[0]) - (SHIFTS - SHIFTS[0])).abs().max() < 0.03  # px


def test_a_blank_wall_tells_no_shift():
    assert camera_shifts(torch.full((2, 4, 3, HEIGHT, WIDTH), 0.5)).abs().max() < 1e-3
