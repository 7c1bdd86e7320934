"""Facts about where a camera is told to sway to."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.sway import Sway


def swaying(clips: int, frames: int, noise_px: float = 0.0) -> list[torch.Tensor]:
    """(T, 2) px each: along x and y a wave about a place of its own, a turn in 27 frames (3 Hz at 80 a second)."""
    generator = torch_generator(0)
    wave = torch.rand(clips, 3, 1, 2, generator=generator) * torch.tensor([2.0, 6.28, 5.0])[:, None, None]
    times = torch.arange(float(frames))[:, None]
    paths = wave[:, 0] * torch.sin(6.28 / 27 * times + wave[:, 1]) + wave[:, 2]
    return list(paths + noise_px * torch.randn(paths.shape, generator=generator))


def learned(paths: list[torch.Tensor]) -> Sway:
    sway = Sway(seen_frames=4)
    sway.fit(paths)
    return sway


def test_a_sway_about_one_place_is_told_from_four_frames():
    sway = learned(swaying(clips=40, frames=60))
    path = torch.stack(swaying(clips=3, frames=50))
    found = sway(path[:, :4], torch.tensor([[1, 10, 40]]).expand(3, -1))
    torch.testing.assert_close(found, path[:, [4, 13, 43]] - path[:, 3:4], rtol=0, atol=0.15)  # px


def test_the_less_sure_the_seen_path_is_the_less_is_told():
    sure, unsure = (learned(swaying(40, 60, noise_px)).weights[9].norm() for noise_px in (0.0, 0.3))
    assert unsure < 0.3 * sure


def test_of_a_camera_on_a_tripod_or_too_little_film_nothing_is_told():
    assert learned([torch.zeros(60, 2)] * 40).weights.abs().max() == 0
    assert learned(swaying(clips=1, frames=50)).weights.abs().max() == 0
    sway = learned(swaying(clips=60, frames=30))
    told = sway(torch.rand(1, 4, 2, generator=torch_generator(1)), torch.tensor([[26, 27, 500]]))
    assert (told[0].abs().sum(1) > 0).tolist() == [True, False, False]


def test_a_mirrored_path_sways_to_the_mirrored_place():
    sway, path = learned(swaying(40, 60)), torch.rand(2, 4, 2, generator=torch_generator(1))
    ahead, mirror = torch.tensor([[5, 20]]).expand(2, -1), torch.tensor([-1.0, 1.0])
    torch.testing.assert_close(sway(path * mirror, ahead), sway(path, ahead) * mirror)
