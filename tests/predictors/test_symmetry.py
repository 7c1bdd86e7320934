"""Facts about averaging over mirrors and turns."""

import pytest
import torch

from physpipe.predictors.base import Seen
from physpipe.predictors.symmetry import mean_over_symmetries, mirrored


def crooked(seen: Seen, asked_times: torch.Tensor) -> torch.Tensor:
    """A forecaster without any symmetry: depends on place, on the picture's corner, and errs to the right."""
    corner = seen.frames[:, -1, 0, 0, 0][:, None, None, None]
    step = torch.tensor([3.0, 1.0]) + 0.1 * seen.xy[:, -1:] * corner
    return seen.xy[:, -1:] + step * asked_times[:, :, None, None]


def scene(height: int, width: int) -> tuple[Seen, torch.Tensor]:
    generator = torch.Generator().manual_seed(0)
    frames = torch.rand(2, 4, 3, height, width, generator=generator)
    xy = torch.rand(2, 4, 3, 2, generator=generator) * torch.tensor([width, height])
    return Seen(frames, xy, torch.arange(4.0).expand(2, -1)), torch.arange(4.0, 9.0).expand(2, -1)


@pytest.mark.parametrize(("flip_x", "flip_y"), [(True, False), (False, True), (True, True)])
def test_a_mirrored_scene_has_the_mirrored_forecast(flip_x, flip_y):
    seen, asked = scene(12, 20)
    axes = [axis for axis, flip in ((-1, flip_x), (-2, flip_y)) if flip]
    other = Seen(seen.frames.flip(axes), mirrored(seen.xy, flip_x, flip_y, 12, 20), seen.times)
    there = mean_over_symmetries(crooked, other, asked)
    torch.testing.assert_close(mirrored(there, flip_x, flip_y, 12, 20), mean_over_symmetries(crooked, seen, asked))


def test_a_turned_square_scene_has_the_turned_forecast():
    seen, asked = scene(16, 16)
    other = Seen(seen.frames.transpose(-1, -2), seen.xy.flip(-1), seen.times)
    there = mean_over_symmetries(crooked, other, asked)
    torch.testing.assert_close(there.flip(-1), mean_over_symmetries(crooked, seen, asked))


def test_a_forecaster_with_the_symmetries_is_left_as_it_is():
    seen, asked = scene(12, 20)

    def still(seen: Seen, asked_times: torch.Tensor) -> torch.Tensor:
        return seen.xy[:, -1:].expand(-1, asked_times.shape[1], -1, -1)

    torch.testing.assert_close(mean_over_symmetries(still, seen, asked), still(seen, asked))
