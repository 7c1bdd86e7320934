"""Facts about carrying uncertainty along a path."""

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.gaussian import squared_mahalanobis
from physpipe.predictors.terrain_law import Motion
from physpipe.predictors.uncertainty import Spread, linearised


def straight(now: Motion) -> Motion:
    return now._replace(place=now.place + now.velocity)


def spread(
    objects: int,
    place: float,
    velocity: float,
    change: float,
    seen: float,
    always: float = 1e-9,
    sway: float = 1e-6,
    frames: float = 2.0,
) -> Spread:
    made = Spread(objects)
    made.logs.copy_(torch.tensor([place, velocity, change, always, seen, sway, frames]).log())
    return made


def start(clips: int, objects: int) -> Motion:
    generator = torch_generator(0)
    return Motion.rolling(
        torch.randn(clips, 1, objects, 2, generator=generator),
        0.1 * torch.randn(clips, 1, objects, 2, generator=generator),
    )


def test_free_flight_spreads_as_a_kalman_filter_says():
    path = linearised(straight, start(2, 1), steps=6)
    cov = spread(1, 0.3, 0.02, 0.01, 0.05)(path.jacobians)
    t = torch.arange(1.0, 7.0)
    noise = torch.tensor([0.01**2 * sum((n - s) ** 2 for s in range(1, n + 1)) for n in range(1, 7)])
    expected = 0.3**2 + (0.02 * t) ** 2 + noise + 0.05**2
    torch.testing.assert_close(cov[0, :, 0, 0, 0], expected, rtol=1e-3, atol=0)
    torch.testing.assert_close(cov[0, :, 0, 0, 1], torch.zeros(6), rtol=0, atol=1e-6)


def test_a_path_that_gathers_makes_a_forecast_surer():
    drag = lambda now: now._replace(place=0.8 * now.place)  # noqa: E731
    cov = spread(1, 0.3, 1e-6, 1e-6, 1e-6)(linearised(drag, start(1, 1), steps=5).jacobians)
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), 0.3 * 0.8 ** torch.arange(1.0, 6.0), rtol=1e-3, atol=0)


def test_linearised_paths_are_the_laws_own():
    path = linearised(straight, start(2, 3), steps=4)
    now = start(2, 3)
    expected = torch.stack([(now.place + n * now.velocity)[:, 0] for n in range(1, 5)], dim=1)
    torch.testing.assert_close(path.place, expected)


def test_known_noise_is_found_again_to_a_tenth_and_nine_tenths_are_covered():
    generator = torch_generator(1)
    clips, steps = 400, 8
    begin = start(clips, 1)
    path = linearised(straight, begin, steps)
    off = 0.03 * torch.randn(clips, 1, 1, 2, generator=generator)
    t = torch.arange(1.0, steps + 1)[:, None, None]
    target = path.place + off * t + 0.05 * torch.randn(clips, steps, 1, 2, generator=generator)
    made = spread(1, 0.01, 0.01, 0.001, 0.01)
    made.fit(path.jacobians, target - path.place, rounds=200)
    cov = made(path.jacobians)
    true = 0.05**2 + (0.03 * torch.arange(1.0, steps + 1)) ** 2
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), true.sqrt(), rtol=0.1, atol=0)
    inside = (squared_mahalanobis(target - path.place, cov) < 4.605).float().mean()
    assert inside.item() == pytest.approx(0.9, abs=0.005)


def test_a_swaying_camera_is_found_again_to_a_tenth_and_covered_at_every_time():
    clips, steps = 400, 24
    path = linearised(straight, start(clips, 1), steps)
    t = torch.arange(1.0, steps + 1)
    true = (0.005**2 + 0.02**2 * (1 - torch.exp(-((t / 6) ** 2)))).sqrt()
    missed = true[:, None, None] * torch.randn(clips, steps, 1, 2, generator=torch_generator(3))
    made = Spread(1)
    made.fit(path.jacobians, missed, rounds=400)
    cov = made(path.jacobians)
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), true, rtol=0.1, atol=0)
    inside = (squared_mahalanobis(missed, cov) < 4.605).float().mean(dim=(0, 2))
    assert (inside - 0.9).abs().max() < 0.06  # four standard errors of 400 clips


def test_lost_tracks_do_not_rule_the_fit():
    jacobians = torch.eye(6).expand(100, 4, 6, 6)
    missed = 0.02 * torch.randn(100, 4, 1, 2, generator=torch_generator(2))
    missed[:3] += 1.0
    made = spread(1, 0.01, 0.001, 0.001, 0.01)
    made.fit(jacobians, missed, rounds=200)
    std = made(jacobians)[0, -1, 0, 0, 0].sqrt().item()
    assert std == pytest.approx(0.02, rel=0.15)


def test_what_the_law_gets_wrong_in_every_frame_grows_as_its_square_and_is_found_again_to_a_tenth():
    clips, steps = 400, 24
    path = linearised(straight, start(clips, 1), steps)
    t = torch.arange(1.0, steps + 1)
    wrong = 0.001 * torch.randn(clips, 1, 1, 2, generator=torch_generator(4))
    missed = (t * (t - 1) / 2)[:, None, None] * wrong  # what is wrong of velocity moves a place in the next frame only
    missed = missed + 0.002 * torch.randn(clips, steps, 1, 2, generator=torch_generator(5))
    made = Spread(1)
    made.fit(path.jacobians, missed, rounds=400)
    cov = made(path.jacobians)
    true = (0.002**2 + (0.001 * t * (t - 1) / 2) ** 2).sqrt()
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt()[5:], true[5:], rtol=0.1, atol=0)
    inside = (squared_mahalanobis(missed, cov) < 4.605).float().mean(dim=(0, 2))
    assert (inside - 0.9).abs().max() < 0.06  # four standard errors of 400 clips


def test_nine_tenths_are_covered_near_and_far_though_misses_are_not_gaussian():
    """Few large misses and many small ones, as after collisions, growing as no part of the model does."""
    clips, steps = 600, 24
    path = linearised(straight, start(clips, 1), steps)
    t = torch.arange(1.0, steps + 1)
    generator = torch_generator(6)
    rare = torch.where(torch.rand(clips, 1, 1, 1, generator=generator) < 0.15, 6.0, 1.0)
    missed = (0.001 * t**0.7)[:, None, None] * rare * torch.randn(clips, steps, 1, 2, generator=generator)
    made = Spread(1)
    made.fit(path.jacobians, missed, rounds=300)
    inside = (squared_mahalanobis(missed, made(path.jacobians)) < 4.605).float()
    for frames in (slice(0, 8), slice(8, 16), slice(16, 24)):
        assert inside[:, frames].mean().item() == pytest.approx(0.9, abs=0.03)
