"""CorrFlow takes any frame, is small, passes gradients on, and can learn."""

import pytest
import torch
from pydantic import ValidationError

from physpipe.core.determinism import torch_generator
from physpipe.flownet.network import CorrFlow, CorrFlowParams, FlowPairs, endpoint_errors

PARAMS = CorrFlowParams(channels=[16, 24], radii=[2, 3], decoder=24, contrast_px=9, inside_weight=1, level_weight=0.4)


def net(seed: int = 0) -> CorrFlow:
    torch.manual_seed(seed)
    return CorrFlow(PARAMS)


def moved_square(dx: int, dy: int, height: int = 40, width: int = 56) -> FlowPairs:
    """A textured square of 12 px that goes (dx, dy) over a still texture of its own."""
    generator = torch_generator(5)
    ground, square = (torch.rand(1, 3, *size, generator=generator) for size in [(height, width), (12, 12)])
    first, second = ground.clone(), ground.clone()
    first[..., 14:26, 20:32] = square
    second[..., 14 + dy : 26 + dy, 20 + dx : 32 + dx] = square
    inside = torch.zeros(1, height, width, dtype=torch.bool)
    inside[:, 14:26, 20:32] = True
    flow = torch.tensor([dx, dy]).view(1, 2, 1, 1) * inside[:, None].float()
    return FlowPairs(first, second, flow, inside)


@pytest.mark.parametrize(("height", "width"), [(40, 56), (37, 51), (128, 96)])
def test_flow_has_the_size_of_the_frames(height, width):
    pictures = torch.rand(2, 2, 3, height, width, generator=torch_generator(1))
    assert net()(*pictures).shape == (2, 2, height, width)


def test_brighter_light_is_no_motion():
    """Contrast is relative: a gain changes the flow only where there is next to no contrast."""
    trained = net()
    for parameter in trained.parameters():
        torch.nn.init.normal_(parameter, std=0.1, generator=torch_generator(6))
    batch = moved_square(4, -3)
    plain, bright = trained(batch.first, batch.second), trained(batch.first, 1.2 * batch.second)
    assert (plain - bright).abs().max() < 0.05 * plain.abs().max()


def test_the_error_counts_both_parts_on_their_own():
    batch = moved_square(3, 4)
    still = endpoint_errors(torch.zeros(1, 2, 40, 56), batch)
    torch.testing.assert_close(still, torch.tensor([0.0, 5.0]), atol=2e-3, rtol=0)  # px; 1e-3 smooths the root
    torch.testing.assert_close(endpoint_errors(batch.flow + 1, batch), torch.full((2,), 2**0.5), atol=1e-5, rtol=0)


def test_a_gradient_reaches_every_weight():
    model = net()
    for level in model.levels:  # zero layers, where a training begins, pass none on
        torch.nn.init.normal_(level.correct.weight, std=0.1, generator=torch_generator(7))
    loss, _ = model.loss(moved_square(4, -3), torch.Generator())
    loss.backward()
    silent = [name for name, each in model.named_parameters() if each.grad is None or not each.grad.abs().sum() > 0]
    assert silent == []


def test_it_learns_one_pair():
    """Endpoint error inside the square below 0.5 px, of 5 px that it went."""
    batch, model = moved_square(4, -3), net()
    optimiser = torch.optim.Adam(model.parameters(), lr=3e-3)
    for _ in range(80):
        optimiser.zero_grad()
        loss, parts = model.loss(batch, torch.Generator())
        loss.backward()
        optimiser.step()
    assert parts["inside_px"] < 0.5
    assert parts["outside_px"] < 0.5


def test_levels_need_a_radius_each():
    with pytest.raises(ValidationError, match="2 levels of channels, 3 radii"):
        CorrFlowParams(channels=[16, 24], radii=[2, 3, 2], decoder=24, contrast_px=9, inside_weight=1, level_weight=0.4)
