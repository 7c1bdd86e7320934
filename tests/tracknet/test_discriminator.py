"""Facts about orders and the network that judges them."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.tracknet.discriminator import MOMENTS, Discriminator, DiscriminatorParams, shuffles


def test_no_shuffle_is_natural_or_reversed_and_each_is_a_permutation():
    orders = shuffles(50, 200, torch_generator(0)).flatten(0, 1)
    natural = torch.arange(MOMENTS)
    assert (orders.sort(1).values == natural).all()
    assert not (orders == natural).all(1).any()
    assert not (orders == natural.flip(0)).all(1).any()
    assert len(orders.unique(dim=0)) == 118  # 5! less the two


def test_the_judge_of_shape_sees_neither_place_nor_size():
    torch.manual_seed(0)
    judge = Discriminator(DiscriminatorParams(width=16, shape_only=True), 56)
    xy = 10 * torch.randn(6, MOMENTS, 2)
    torch.testing.assert_close(judge(xy), judge(3 * xy + torch.tensor([20.0, -7.0])), rtol=1e-3, atol=1e-3)


def test_the_paper_judge_sees_the_place():
    torch.manual_seed(0)
    judge = Discriminator(DiscriminatorParams(width=16, shape_only=False), 56)
    xy = 10 * torch.randn(6, MOMENTS, 2)
    assert (judge(xy) - judge(xy + 20)).abs().min() > 1e-3
