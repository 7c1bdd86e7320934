"""Facts about averaging over mirrors and turns."""

import pytest
import torch

from physpipe.predictors.base import Forecast, Seen
from physpipe.predictors.symmetry import mean_over_symmetries, mirrored, mirrored_cov


def crooked(seen: Seen, asked_times: torch.Tensor) -> Forecast:
    """A forecaster without any symmetry: depends on place, on the picture's corner, and errs to the right."""
    corner = seen.frames[:, -1, 0, 0, 0][:, None, None, None]
    step = torch.tensor([3.0, 1.0]) + 0.1 * seen.xy[:, -1:] * corner
    mean = seen.xy[:, -1:] + step * asked_times[:, :, None, None]
    slant = torch.tensor([[4.0, 1.0], [1.0, 2.0]]) * (1 + corner.unsqueeze(-1))
    return Forecast(mean, slant.expand(*mean.shape, 2))


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
    there, here = mean_over_symmetries(crooked, other, asked), mean_over_symmetries(crooked, seen, asked)
    torch.testing.assert_close(mirrored(there.mean, flip_x, flip_y, 12, 20), here.mean)
    torch.testing.assert_close(mirrored_cov(there.cov, flip_x, flip_y), here.cov, rtol=1e-4, atol=1e-4)  # px^2


def test_a_turned_square_scene_has_the_turned_forecast():
    seen, asked = scene(16, 16)
    other = Seen(seen.frames.transpose(-1, -2), seen.xy.flip(-1), seen.times)
    there, here = mean_over_symmetries(crooked, other, asked), mean_over_symmetries(crooked, seen, asked)
    torch.testing.assert_close(there.mean.flip(-1), here.mean)
    torch.testing.assert_close(there.cov.flip(-1, -2), here.cov, rtol=1e-4, atol=1e-4)  # px^2


def test_a_forecaster_with_the_symmetries_is_left_as_it_is():
    seen, asked = scene(12, 20)

    def still(seen: Seen, asked_times: torch.Tensor) -> Forecast:
        return Forecast(seen.xy[:, -1:].expand(-1, asked_times.shape[1], -1, -1))

    found = mean_over_symmetries(still, seen, asked)
    torch.testing.assert_close(found.mean, still(seen, asked).mean)
    assert found.cov is None


def test_a_mirrored_covariance_is_that_of_mirrored_points():
    points = torch.randn(500, 2, generator=torch.Generator().manual_seed(1)) @ torch.tensor([[3.0, 1.0], [0.0, 0.5]])
    for flip_x, flip_y in ((True, False), (False, True), (True, True)):
        there = torch.cov(mirrored(points, flip_x, flip_y, 12, 20).T)
        torch.testing.assert_close(mirrored_cov(torch.cov(points.T), flip_x, flip_y), there)


def test_the_covariance_is_that_of_points_drawn_from_every_mirrored_forecast():
    """Forecasts that err to the right, each sharp: four mirrors of a frame leave two places apart in x."""
    seen, asked = scene(12, 20)

    def right(seen: Seen, asked_times: torch.Tensor) -> Forecast:
        mean = seen.xy[:, -1:].expand(-1, asked_times.shape[1], -1, -1) + torch.tensor([3.0, 0.0])
        return Forecast(mean, torch.diag(torch.tensor([4.0, 1.0])).expand(*mean.shape, 2))

    found = mean_over_symmetries(right, seen, asked)
    torch.testing.assert_close(found.mean, seen.xy[:, -1:].expand(-1, 5, -1, -1))
    torch.testing.assert_close(found.cov, torch.diag(torch.tensor([4.0 + 9.0, 1.0])).expand_as(found.cov))
