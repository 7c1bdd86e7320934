"""Facts about the losses."""

import math

import numpy as np
import pytest
import torch
import worlds

from physpipe.core.determinism import torch_generator
from physpipe.tracknet.discriminator import MOMENTS, Discriminator, DiscriminatorParams
from physpipe.tracknet.losses import (
    causality,
    causality_by_coin,
    even_motion_target,
    motion_cross_entropy,
    motion_target,
)


def judge(seed: int = 0) -> Discriminator:
    torch.manual_seed(seed)
    return Discriminator(DiscriminatorParams(width=32, shape_only=True), 56)


def evenly(xy: torch.Tensor) -> torch.Tensor:
    return torch.full((len(xy),), 1 / len(xy))


def test_a_judge_that_cannot_tell_costs_a_coin():
    blind = judge()
    torch.nn.init.zeros_(blind.judge[-1].weight)
    xy = torch.randn(7, MOMENTS, 2)
    assert causality(blind, xy, evenly(xy), 8, torch_generator(0)).item() == pytest.approx(math.log(2))
    assert causality_by_coin(blind, xy, evenly(xy), torch_generator(0)).item() == pytest.approx(math.log(2))


def test_all_shuffles_at_once_have_the_coin_s_expectation():
    eye = judge()
    xy = 10 * torch.randn(1, MOMENTS, 2, generator=torch_generator(1)).cumsum(1).expand(4000, -1, -1)
    with torch.no_grad():
        free = causality(eye, xy, evenly(xy), 8, torch_generator(2)).item()
        coin = torch.stack(
            [causality_by_coin(eye, xy[:400], evenly(xy[:400]), torch_generator(3, draw)) for draw in range(40)]
        )
    standard_error = coin.std().item() / math.sqrt(len(coin))
    assert free == pytest.approx(coin.mean().item(), abs=4 * standard_error)


def test_the_order_of_smooth_motion_is_learned_and_that_of_noise_is_not():
    def trained(positions) -> float:
        eye = judge()
        optimiser = torch.optim.Adam(eye.parameters(), lr=5e-3)
        for step in range(150):
            optimiser.zero_grad()
            xy = positions(torch_generator(0, step))
            loss = causality(eye, xy, evenly(xy), 8, torch_generator(1, step))
            loss.backward()
            optimiser.step()
        xy = positions(torch_generator(9))
        return causality(eye, xy, evenly(xy), 8, torch_generator(9)).item()

    def smooth(generator: torch.Generator) -> torch.Tensor:
        start, velocity = torch.randn(2, 64, 1, 2, generator=generator)
        return start + 3 * velocity * torch.arange(MOMENTS)[:, None]

    assert trained(smooth) < 0.1  # nats
    assert trained(lambda generator: torch.randn(64, MOMENTS, 2, generator=generator)) > 0.6


def film() -> tuple[torch.Tensor, torch.Tensor, np.ndarray]:
    xy = worlds.orbit(24, 0.4)
    frames = torch.from_numpy(worlds.draw(xy[:, None], [worlds.RED], seed=0)).movedim(-1, 1).float() / 255
    return frames, frames.median(0).values.expand_as(frames), xy


def test_motion_stands_where_the_ball_is():
    frames, background, xy = film()
    target = motion_target(frames, background, stride=4)
    rows, columns = np.divmod(target.flatten(1).argmax(1).numpy(), target.shape[2])
    found = np.stack([4 * columns + 1.5, 4 * rows + 1.5], 1)
    assert np.abs(found - xy).max() < 4  # pixels: within one cell
    torch.testing.assert_close(target.flatten(1).sum(1), torch.ones(24))


def two_of_unlike_contrast() -> tuple[torch.Tensor, torch.Tensor]:
    background = torch.full((1, 3, 40, 56), 0.5)
    frames = background.clone()
    frames[:, :, 8:16, 8:16] += 0.3
    frames[:, :, 24:32, 40:48] -= 0.1
    return frames, background


def test_a_faint_object_weighs_nearly_as_much_as_another_when_evened_out():
    frames, background = two_of_unlike_contrast()
    plain, evened = motion_target(frames, background, 4), even_motion_target(frames, background, 4, 0.02, 5)
    assert plain[0, 6:8, 10:12].sum().item() == pytest.approx(1 / (1 + 3**4), rel=0.05)  # the fourth power of contrast
    assert 0.25 < evened[0, 6:8, 10:12].sum().item() < 0.5
    assert evened.sum().item() == pytest.approx(1)


def test_a_frame_in_which_nothing_moves_teaches_little_beside_one_in_which_something_does():
    frames, background = two_of_unlike_contrast()
    noise = background + 0.01 * torch.randn(background.shape, generator=torch_generator(0))
    both = even_motion_target(torch.cat([frames, noise]), torch.cat([background] * 2), 4, 0.02, 5)
    assert both[0].sum().item() == pytest.approx(1)
    assert both[1].sum().item() < 0.05


def test_a_change_of_light_is_no_motion():
    _, background, _ = film()
    assert motion_target(background + 0.1, background, 4).sum().item() == pytest.approx(0, abs=1e-3)


def test_the_warm_start_is_least_at_its_target():
    frames, background, _ = film()
    target = motion_target(frames, background, 4)
    at_target = motion_cross_entropy((target + 1e-9).log(), target)
    assert at_target < motion_cross_entropy(torch.zeros_like(target), target)
    assert motion_cross_entropy(torch.zeros_like(target), target).item() == pytest.approx(math.log(140), rel=1e-4)
