"""Correlation finds the shift, warping undoes it, sharp upsampling invents no value."""

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.flownet.matching import convex_upsample, correlation, likeliest_offset, warp

H, W = 12, 20


def texture(channels: int, seed: int = 0) -> torch.Tensor:
    return torch.randn(2, channels, H, W, generator=torch_generator(seed))


@pytest.mark.parametrize(("dx", "dy"), [(0, 0), (2, -1), (-3, 3), (1, 2)])
def test_correlation_of_a_shifted_map_peaks_at_the_shift(dx, dy):
    """Of unit vectors, whose product is highest, 1, with themselves."""
    radius, side = 3, 7
    first = torch.nn.functional.normalize(texture(16), dim=1)
    matches = 16 * correlation(first, first.roll((dy, dx), (2, 3)), radius)
    assert matches.shape == (2, side**2, H, W)
    inner = matches[:, :, 3:-3, 3:-3]
    assert (inner.argmax(1) == (dy + radius) * side + dx + radius).all()
    torch.testing.assert_close(inner.amax(1), torch.ones_like(inner[:, 0]))


def test_correlation_is_the_mean_product_of_every_pair_of_cells():
    first, second, radius = texture(5), texture(5, seed=1), 2
    found = correlation(first, second, radius)
    product = (first[0, :, 4, 7] * second[0, :, 4 + 1, 7 - 2]).mean()
    torch.testing.assert_close(found[0, (1 + radius) * 5 - 2 + radius, 4, 7], product)
    assert (found[:, :5, :2] == 0).all()  # two rows up from the first two rows there is nothing


def test_the_likeliest_offset_is_that_of_the_only_match_and_none_where_all_match_alike():
    matches = torch.zeros(1, 25, H, W)
    assert likeliest_offset(matches, torch.tensor(10.0)).abs().max() < 1e-6
    matches[:, (1 + 2) * 5 + (-2 + 2)] = 100
    wanted = torch.tensor([-2.0, 1.0]).view(1, 2, 1, 1).expand(1, 2, H, W)
    torch.testing.assert_close(likeliest_offset(matches, torch.tensor(10.0)), wanted)


@pytest.mark.parametrize(("dx", "dy"), [(2.0, -1.0), (0.5, 1.25), (-3.75, 0.0)])
def test_warping_back_by_the_known_flow_recovers_a_ramp_exactly(dx, dy):
    """A ramp is its own bilinear interpolation, so the only error is rounding."""
    rows, columns = torch.meshgrid(torch.arange(float(H)), torch.arange(float(W)), indexing="ij")
    first = (3 * columns - 2 * rows).expand(1, 2, H, W)
    second = (3 * (columns - dx) - 2 * (rows - dy)).expand(1, 2, H, W)  # the ramp moved by (dx, dy)
    flow = torch.tensor([dx, dy]).view(1, 2, 1, 1).expand(1, 2, H, W)
    back = warp(second, flow)
    torch.testing.assert_close(back[..., 4:-4, 4:-4], first[..., 4:-4, 4:-4])


def test_a_whole_shift_recovers_any_picture_inside():
    first = texture(3)
    flow = torch.tensor([3.0, -2.0]).view(1, 2, 1, 1).expand(2, 2, H, W)
    back = warp(first.roll((-2, 3), (2, 3)), flow)
    torch.testing.assert_close(back[..., 2:, :-3], first[..., 2:, :-3])


def test_warping_agrees_with_grid_sample_and_so_does_its_gradient():
    flow = 4 * texture(2, seed=2)
    image, twin = texture(3).requires_grad_(), texture(3).requires_grad_()
    found = warp(image, flow)
    x = flow[:, 0] + torch.arange(W)
    y = flow[:, 1] + torch.arange(H)[:, None]
    grid = torch.stack([2 * x / (W - 1) - 1, 2 * y / (H - 1) - 1], -1)
    wanted = torch.nn.functional.grid_sample(twin, grid, padding_mode="border", align_corners=True)
    torch.testing.assert_close(found, wanted, atol=1e-4, rtol=1e-4)
    for each in (found, wanted):
        (each * texture(3, seed=3)).sum().backward()
    torch.testing.assert_close(image.grad, twin.grad, atol=1e-3, rtol=1e-3)


def test_sharp_upsampling_keeps_a_constant_and_can_pick_any_neighbour():
    flow = torch.full((2, 2, H, W), 1.5)
    weights = torch.randn(2, 36, H, W, generator=torch_generator(4))
    torch.testing.assert_close(convex_upsample(flow, weights), torch.full((2, 2, 2 * H, 2 * W), 1.5))
    flow = texture(2)
    pick = torch.full((2, 9, 2, 2, H, W), -100.0)
    pick[:, 4, 0] = 100  # upper fine pixels take their own cell ...
    pick[:, 5, 1] = 100  # ... lower ones the right neighbour's
    fine = convex_upsample(flow, pick.view(2, 36, H, W))
    torch.testing.assert_close(fine[:, :, ::2, ::2], flow)
    torch.testing.assert_close(fine[:, :, 1::2, 1:-2:2], flow[..., 1:])
