"""Facts about the schedule and the masking."""

from dataclasses import replace

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.tracknet.detector import DetectorParams
from physpipe.tracknet.discriminator import DiscriminatorParams
from physpipe.tracknet.heatmap import distribution
from physpipe.tracknet.model import BottleneckParams, LossParams, TrackNet, TrackNetParams
from physpipe.tracknet.moments import Moments, masked


def params(end_px: float = 0.5, warm_start_steps: int = 0) -> TrackNetParams:
    return TrackNetParams(
        detector=DetectorParams(width=4, layers=1, stride=4),
        discriminator=DiscriminatorParams(width=8, shape_only=True),
        losses=LossParams(causality=1, entropy=0.01, equivariance=0.001, motion=0),
        bottleneck=BottleneckParams(start_px=0.02 if end_px else 0, end_px=end_px, growth=1.5, winning=0.5),
        negatives=4,
        turned_share=0.5,
        mirrored=True,
        flicker=0.1,
        warm_start_steps=warm_start_steps,
        peaks=None,
    )


def net(**settings) -> TrackNet:
    torch.manual_seed(0)
    return TrackNet(params(**settings), 56)


def batch() -> Moments:
    generator = torch_generator(0)
    return Moments(torch.rand(3, 5, 3, 40, 56, generator=generator), torch.rand(3, 3, 40, 56, generator=generator))


@pytest.mark.parametrize(("running", "direction"), [(0.1, 1), (0.69, -1)])
def test_noise_grows_while_the_judge_wins_and_shrinks_while_it_loses(running, direction):
    model = net()
    model.bottleneck.sigma.fill_(0.1)
    model.bottleneck.running.fill_(running)
    model.loss(batch(), torch_generator(1))
    assert model.bottleneck.sigma.item() == pytest.approx(0.1 * 1.5**direction)


def test_noise_keeps_its_bounds_and_the_ramp_ends_at_one():
    model = net()
    model.bottleneck.sigma.fill_(0.49)
    model.bottleneck.running.fill_(0.0)
    model.loss(batch(), torch_generator(1))
    assert model.bottleneck.sigma.item() == pytest.approx(0.5)
    assert model.bottleneck.ramp().item() == pytest.approx(1)


def test_without_noise_every_loss_has_its_full_weight_from_the_start():
    model = net(end_px=0)
    loss, parts = model.loss(batch(), torch_generator(1))
    expected = parts["order_nats"] + 0.01 * parts["entropy_nats"] + 0.001 * parts["siamese_px2"]
    assert loss.item() == pytest.approx(expected, rel=1e-5)


def test_the_warm_start_comes_first_and_ends():
    model = net(warm_start_steps=2)
    kinds = [set(model.loss(batch(), torch_generator(step))[1]) for step in range(3)]
    assert kinds[0] == kinds[1] == {"motion_nats"}
    assert "order_nats" in kinds[2]


def test_the_loss_depends_on_the_generator_alone():
    first, second = net(), net()
    assert first.loss(batch(), torch_generator(5))[0] == second.loss(batch(), torch_generator(5))[0]


def test_no_probability_is_left_where_ignored_even_at_the_highest_score():
    logits = torch.zeros(2, 4, 6)
    logits[:, 1, 2] = 30
    ignored = torch.zeros(2, 4, 6, dtype=torch.bool)
    ignored[:, :2] = True
    heat = distribution(masked(logits, ignored))
    assert heat[ignored].max() < 1e-30
    torch.testing.assert_close(heat[~ignored], torch.full((24,), 1 / 12))


def test_masked_moments_are_learned_from_without_looking_under_the_mask():
    model = net(warm_start_steps=1)
    hidden = torch.ones(3, 5, 10, 14, dtype=torch.bool)
    hidden[..., 5:, 7:] = False
    loss, _ = model.loss(replace(batch(), ignored=hidden), torch_generator(0))
    assert torch.isfinite(loss)


def test_restarting_keeps_the_weights():
    model = net()
    for step in range(3):
        model.loss(batch(), torch_generator(step))
    weights = [each.clone() for each in model.parameters()]
    model.restart()
    assert (model.steps.item(), model.bottleneck.sigma.item()) == (0, pytest.approx(0.02))
    assert all(torch.equal(old, new) for old, new in zip(weights, model.parameters(), strict=True))
