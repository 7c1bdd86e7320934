"""Facts about how far forecasts miss."""

import pytest
import torch
from torch import Tensor

from physpipe.core.determinism import torch_generator
from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen, Window
from physpipe.predictors.gaussian import SURE, squared_mahalanobis
from physpipe.predictors.misses import Misses, fitted, power

AHEAD = torch.arange(1.0, 25.0)


class Stays(Predictor):
    """Forecasts that nothing moves."""

    Params = Section
    seen_frames = 4

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        return Forecast(seen.xy[:, -1:].expand(-1, asked_times.shape[1], -1, -1))


class KnowsHowSure(Stays):
    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        mean = super().forward(seen, asked_times).mean
        return Forecast(mean, 7 * torch.eye(2).expand(*mean.shape, 2))


class StaysUpTo(Stays):
    sees_end = True


def wandering(clips: int, seed: int, first: int = 0) -> Window:
    """Two balls that have stood at the same place and wander off, 0.5 px times the square root of the time."""
    steps = torch.randn(clips, len(AHEAD), 2, 2, generator=torch_generator(seed))
    xy = torch.full((clips, 4, 2, 2), 20.0)
    times = torch.arange(first, first + 4.0).expand(clips, -1)
    asked = (first + 3 + AHEAD).expand(clips, -1)
    later = 20 + 0.5 * steps.cumsum(1)
    return Window(Seen(torch.zeros(clips, 4, 3, 16, 20), xy, times), asked, later, 80.0, torch.cat([xy, later], dim=1))


def test_a_power_of_time_is_found_again():
    law = torch.tensor([-1.0, 1.7])
    squares = power(law, AHEAD)[:, None] * SURE
    torch.testing.assert_close(fitted(squares.expand(5, -1, 2), AHEAD), law, rtol=0, atol=1e-4)


def test_nothing_is_claimed_before_anything_was_seen():
    assert not Misses().known
    window = wandering(2, seed=0)
    assert Stays(Section(), 2).forecast(window.seen, window.asked_times).cov is None


def test_a_predictor_without_a_covariance_is_as_sure_as_it_was_right_on_held_out_film():
    net = Stays(Section(), 2)
    net.calibrate(wandering(400, seed=1))
    fresh = wandering(400, seed=2, first=7)
    cov = net.forecast(fresh.seen, fresh.asked_times).cov
    assert cov is not None
    assert cov.shape == (400, len(AHEAD), 2, 2, 2)
    assert cov[0, 15, 0, 0, 0].item() == pytest.approx(16 * 0.5**2, rel=0.1)  # px^2 after 16 frames
    inside = (squared_mahalanobis(fresh.target - 20, cov) < SURE).float().mean(dim=(0, 2))
    assert (inside - 0.9).abs().max() < 0.045  # four standard errors of 400 clips of two balls


def test_positions_stay_and_so_does_what_a_predictor_says_itself():
    window = wandering(3, seed=3)
    for net in (Stays(Section(), 2), KnowsHowSure(Section(), 2)):
        net.calibrate(window)
        made = net.forecast(window.seen, window.asked_times)
        torch.testing.assert_close(made.mean, net(window.seen, window.asked_times).mean)
    assert not net.misses.known
    torch.testing.assert_close(made.cov, 7 * torch.eye(2).expand_as(made.cov))


def test_no_power_of_time_is_fitted_to_one_that_sees_the_end():
    net = StaysUpTo(Section(), 2)
    net.calibrate(wandering(20, seed=4))
    assert not net.misses.known
