"""Contrast knows no light, features are standardised, and an untaught level follows half the likeliest match."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.flownet.layers import Level, contrast, features

H, W = 24, 40


def texture(channels: int = 3, seed: int = 0) -> torch.Tensor:
    return torch.rand(2, channels, H, W, generator=torch_generator(seed))


def test_contrast_of_an_even_picture_is_nothing_and_of_a_ramp_the_same_everywhere_inside():
    assert contrast(torch.full((1, 3, H, W), 0.7), 9).abs().max() < 1e-4
    ramp = torch.arange(float(W)).expand(1, 3, H, W) / W
    assert contrast(ramp, 9)[..., 8:-8].abs().max() < 1e-4  # a pixel lies at the mean of its surroundings


def test_neither_brighter_nor_added_light_changes_contrast():
    plain = contrast(texture(), 9)
    torch.testing.assert_close(contrast(texture() + 0.3, 9), plain, atol=1e-4, rtol=1e-4)
    assert (contrast(1.2 * texture(), 9) - plain).abs().max() < 0.02 * plain.abs().max()  # 0.01 of 1 is noise


def test_features_have_half_the_size_mean_zero_and_variance_one():
    torch.manual_seed(0)
    found = features(3, 8)(texture())
    assert found.shape == (2, 8, H // 2, W // 2)
    torch.testing.assert_close(found.mean((2, 3)), torch.zeros(2, 8), atol=1e-5, rtol=0)
    torch.testing.assert_close(found.var((2, 3), correction=0), torch.ones(2, 8), atol=1e-2, rtol=0)


def test_an_untaught_level_takes_half_the_likeliest_step_and_adds_it_to_what_it_is_given():
    """Its gate begins half open; 4 px a cell and one cell to the right make 2 px."""
    maps = torch.nn.functional.instance_norm(torch.randn(1, 64, H, W, generator=torch_generator(1)))
    shifted = maps.roll(1, 3)
    alone, state = Level(64, 2, 16, 0)(maps, shifted, None, None, 4)
    inner = alone[..., 3:-3, 3:-3]
    torch.testing.assert_close(inner[:, 0].mean(), torch.tensor(2.0), atol=0.05, rtol=0)
    torch.testing.assert_close(inner[:, 1].mean(), torch.tensor(0.0), atol=0.05, rtol=0)
    given = torch.full((1, 2, H // 2, W // 2), 4.0)  # one cell right and down: nothing is left
    finer, _ = Level(64, 2, 16, 16)(maps, shifted.roll(1, 2), given, state[..., ::2, ::2], 4)
    torch.testing.assert_close(finer[..., 4:-4, 4:-4].mean(), torch.tensor(4.0), atol=0.05, rtol=0)
