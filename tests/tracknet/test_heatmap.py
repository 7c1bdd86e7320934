"""Facts about distributions on a grid of cells."""

import math

import pytest
import torch

from physpipe.tracknet.heatmap import cell_centres, distribution, entropy, expected_position


def test_a_single_cell_gives_its_centre_and_no_entropy():
    heat = torch.zeros(1, 5, 7)
    heat[0, 3, 6] = 1
    assert expected_position(heat, stride=4).tolist() == [[25.5, 13.5]]  # pixels 24..27 and 12..15
    assert entropy(heat).item() == 0


def test_a_flat_map_gives_the_middle_of_the_frame_and_the_largest_entropy():
    heat = distribution(torch.full((2, 5, 7), 3.0))
    torch.testing.assert_close(expected_position(heat, 2), torch.tensor([[6.5, 4.5]] * 2))  # 14 x 10 pixels
    torch.testing.assert_close(entropy(heat), torch.full((2,), math.log(35)))


def test_mass_between_two_cells_gives_the_point_between():
    heat = torch.zeros(1, 4, 6)
    heat[0, 1, 2], heat[0, 1, 3] = 0.25, 0.75
    torch.testing.assert_close(expected_position(heat, 4), torch.tensor([[1.5 + 4 * 2.75, 5.5]]))


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16])
def test_positions_keep_sub_pixel_precision_whatever_the_type_of_the_scores(dtype):
    logits = torch.full((1, 4, 32), -50.0, dtype=dtype)
    logits[0, 2, 30:] = 0
    with torch.autocast("cpu", torch.bfloat16):
        x = expected_position(distribution(logits), 4)[0, 0].item()
    assert x == pytest.approx(cell_centres(32, 4)[30:].mean().item(), abs=1e-3)  # pixels


def test_a_cell_without_any_probability_has_a_finite_slope():
    logits = torch.zeros(1, 4, 6, requires_grad=True)
    hidden = torch.zeros(1, 4, 6)
    hidden[0, 0] = -500
    entropy(distribution(logits + hidden)).sum().backward()
    assert torch.isfinite(logits.grad).all()
