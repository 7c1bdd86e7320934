"""Facts about several places in one heat map."""

import math

import torch

from physpipe.core.determinism import torch_generator
from physpipe.tracknet.heatmap import entropy, expected_position
from physpipe.tracknet.places import PeakParams, around, linked, peaks, taken, whole

PEAKS = PeakParams(slots=3, apart_px=9, window_px=7, least_mass=0.1, even=0.02, nearby_cells=5)


def bump(x: float, y: float, height: float = 1.0) -> torch.Tensor:
    """(1, 10, 14) cells of a 40 x 56 frame, a Gaussian of 2.5 px around (x, y)."""
    ys, xs = 4 * torch.arange(10.0) + 1.5, 4 * torch.arange(14.0) + 1.5
    return height * torch.exp(-((xs - x) ** 2 + (ys[:, None] - y) ** 2) / 12.5)[None]


def normalised(heat: torch.Tensor) -> torch.Tensor:
    return heat / heat.sum((1, 2), keepdim=True)


def test_the_whole_map_is_the_paper_s_single_place():
    heat = normalised(torch.rand(4, 10, 14, generator=torch_generator(0)))
    place = whole(heat, 4)
    torch.testing.assert_close(place.xy[:, 0], expected_position(heat, 4))
    torch.testing.assert_close(place.spread[:, 0], entropy(heat))
    assert place.mass.tolist() == [[1.0]] * 4


def test_two_bumps_are_found_with_their_shares_the_higher_first():
    heat = normalised(bump(13.5, 9.5, 3.0) + bump(41.5, 29.5))  # centres of cells
    centres = peaks(heat, 4, PEAKS)
    assert centres[0, :2].tolist() == [[13.5, 9.5], [41.5, 29.5]]
    found = around(heat, 4, centres, PEAKS.window_px)
    torch.testing.assert_close(found.xy[0, :2], torch.tensor([[13.5, 9.5], [41.5, 29.5]]), atol=0.02, rtol=0)
    torch.testing.assert_close(found.mass[0, :2], torch.tensor([0.75, 0.25]), atol=0.02, rtol=0)  # less the tails
    assert found.mass[0, 2] < 0.01


def test_a_single_bump_has_no_second_peak_on_its_slope():
    found = around(normalised(bump(26, 18)), 4, peaks(normalised(bump(26, 18)), 4, PEAKS), PEAKS.window_px)
    assert found.mass[0, 0] > 0.95
    assert found.mass[0, 1:].max() < 0.02


def test_every_cell_belongs_to_one_place_at_most():
    heat = normalised(torch.rand(5, 10, 14, generator=torch_generator(1)))
    centres = torch.tensor([[[20.0, 20.0], [28.0, 20.0], [20.0, 28.0]]]).expand(5, -1, -1)
    assert around(heat, 4, centres, 60).mass.sum(1).max() <= 1 + 1e-6


def test_a_place_is_where_its_own_cells_are_not_its_neighbour_s():
    heat = normalised(bump(21.5, 17.5) + bump(33.5, 17.5))  # 12 px apart, 3 cells
    found = around(heat, 4, peaks(heat, 4, PEAKS), PEAKS.window_px)
    assert (found.xy[0, :2, 0].sort().values - torch.tensor([21.5, 33.5])).abs().max() < 0.3  # pixels


def test_the_spread_of_a_flat_share_is_the_log_of_its_cells():
    heat = torch.full((1, 10, 14), 1 / 140)
    found = around(heat, 4, torch.tensor([[[25.5, 17.5]]]), 4.5)  # a cell and its four neighbours
    torch.testing.assert_close(found.spread, torch.tensor([[math.log(5)]]))


def test_links_undo_any_exchange_of_places_between_moments():
    generator = torch_generator(2)
    smooth = torch.tensor([[10.0, 10.0], [40.0, 12.0], [25.0, 30.0]]) + 2 * torch.arange(5.0)[:, None, None]
    exchange = torch.stack([torch.randperm(3, generator=generator) for _ in range(5)])
    mixed = taken(smooth, exchange)[None]
    followed = taken(mixed, linked(mixed))[0]
    torch.testing.assert_close(followed, taken(smooth, exchange[:1].expand(5, -1)))


def test_the_gradient_reaches_the_scores_through_places_but_not_through_the_choice_of_peaks():
    logits = torch.rand(2, 10, 14, generator=torch_generator(3), requires_grad=True)
    heat = logits.flatten(1).softmax(1).view(logits.shape)
    centres = peaks(heat, 4, PEAKS)
    assert not centres.requires_grad
    around(heat, 4, centres, PEAKS.window_px).xy.sum().backward()
    assert torch.isfinite(logits.grad).all()
    assert logits.grad.abs().max() > 0
