"""Facts about how faint shading is brought out."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.relief import MOST, WIDTHS, Wide, relief

HEIGHT, WIDTH = 20, 28


def patchy() -> torch.Tensor:
    """Three pictures whose brightness lies between 0.3 and 0.7."""
    return 0.3 + 0.4 * torch.rand(3, 3, HEIGHT, WIDTH, generator=torch_generator(1))


def test_an_even_picture_has_none():
    assert relief(torch.full((2, 3, HEIGHT, WIDTH), 0.4)).abs().max() < 1e-4  # float32, times GAIN


def test_is_there_once_a_width():
    assert relief(patchy()).shape == (3, len(WIDTHS), HEIGHT, WIDTH)


def test_what_outshines_its_surroundings_is_positive_and_its_surroundings_negative():
    picture = torch.full((1, 3, HEIGHT, WIDTH), 0.4)
    picture[..., 10, 14] = 0.42
    found = relief(picture)
    assert (found[..., 10, 14] > 0.2).all()
    assert (found[..., 10, 13] < 0).all()


def test_half_the_light_leaves_shading_as_it_is():
    bright = 0.5 + 0.02 * torch.rand(1, 3, HEIGHT, WIDTH, generator=torch_generator(2))
    assert (relief(bright / 2) - relief(bright)).abs().max() < 0.05 * relief(bright).abs().max()


def test_a_mirrored_picture_has_mirrored_shading():
    torch.testing.assert_close(relief(patchy().flip(3)), relief(patchy()).flip(3))


def test_a_bright_rim_is_cut_off():
    picture = torch.full((1, 3, HEIGHT, WIDTH), 0.2)
    picture[..., 5] = 1
    assert relief(picture).max() == MOST


def test_a_block_sees_as_far_as_its_cells_are_apart():
    block, state = Wide(8, dilation=2), torch.zeros(1, 8, 9, 11, requires_grad=True)
    reach = torch.autograd.grad(block.mend[2](state)[0, :, 4, 5].sum(), state)[0].abs().sum(1)[0]
    assert sorted({int(x) for _, x in reach.nonzero()}) == [3, 5, 7]
    assert block(state).shape == state.shape
