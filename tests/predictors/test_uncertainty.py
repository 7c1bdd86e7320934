"""Facts about carrying uncertainty along a path."""

from collections.abc import Callable

import pytest
import torch
from torch import Tensor

from physpipe.core.determinism import torch_generator
from physpipe.predictors.gaussian import squared_mahalanobis
from physpipe.predictors.terrain_law import Motion
from physpipe.predictors.uncertainty import Spread, around, carried

SURE = 4.605
"""Squared distance within which 90 % of a bivariate Gaussian lie, -2 log 0.1."""


def straight(now: Motion) -> Motion:
    return now._replace(place=now.place + now.velocity)


def between_walls(now: Motion) -> Motion:
    """Thrown back at 1 and -1 in both coordinates, wherever in the frame it gets there."""
    place = now.place + now.velocity
    out = place.abs() > 1
    return now._replace(
        place=torch.where(out, 2 * place.sign() - place, place), velocity=torch.where(out, -1.0, 1.0) * now.velocity
    )


def along(law: Callable[[Motion], Motion], now: Motion, steps: int) -> Tensor:
    """What is carried along the path of `now`."""
    now, paths = around(now), []
    for _ in range(steps):
        now = law(now)
        paths.append(now.place)
    return carried(torch.stack(paths, dim=1))


def spread(place: float, velocity: float, rest: float = 1e-6, power: float = 0.0) -> Spread:
    """Of standard deviations: `rest` grows with that power of the frame."""
    made = Spread()
    made.start.copy_(torch.tensor([place, velocity]).log())
    made.rest.copy_(2 * torch.tensor([torch.tensor(rest).log(), power]))
    return made


def start(clips: int, objects: int) -> Motion:
    generator = torch_generator(0)
    return Motion.rolling(
        torch.randn(clips, 1, objects, 2, generator=generator),
        0.1 * torch.randn(clips, 1, objects, 2, generator=generator),
    )


def test_free_flight_spreads_by_place_velocity_and_all_else():
    cov = spread(0.3, 0.02, rest=0.05, power=1.5)(along(straight, start(2, 1), steps=6))
    t = torch.arange(1.0, 7.0)
    expected = 0.3**2 + (0.02 * t) ** 2 + (0.05 * t**1.5) ** 2
    torch.testing.assert_close(cov[0, :, 0, 0, 0], expected, rtol=1e-3, atol=0)
    torch.testing.assert_close(cov[0, :, 0, 0, 1], torch.zeros(6), rtol=0, atol=1e-6)


def test_a_path_that_gathers_makes_a_forecast_surer():
    drag = lambda now: now._replace(place=0.8 * now.place)  # noqa: E731
    cov = spread(0.3, 1e-6)(along(drag, start(1, 1), steps=5))
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), 0.3 * 0.8 ** torch.arange(1.0, 6.0), rtol=1e-3, atol=0)


def test_walls_turn_what_is_carried_and_do_not_enlarge_it():
    """Whether the wall is reached at the end of a frame or in the next one."""
    begin = Motion.rolling(torch.tensor([0.51, 0.35]).reshape(1, 1, 1, 2), torch.tensor([0.12, 0.2]).expand(1, 1, 1, 2))
    found = along(between_walls, begin, steps=20)[0, :, :, 0]
    t = torch.arange(1.0, 21.0)
    clear = [9, 14, 19]  # frames from which on no start is at a wall while another is not
    for axis in range(2):
        torch.testing.assert_close(found[clear, axis, axis].abs(), torch.ones(3), rtol=1e-3, atol=0)
        torch.testing.assert_close(found[clear, 2 + axis, axis].abs(), t[clear], rtol=1e-3, atol=0)
    assert found[:, :2].abs().max() < 1.001


def test_objects_that_do_not_meet_carry_their_own_errors_alone():
    found = along(straight, start(2, 3), steps=4)  # (2, 4, 12, 3, 2)
    t = torch.arange(1.0, 5.0)
    own = torch.eye(6).unflatten(1, (3, 2))
    expected = torch.cat([own.expand(4, -1, -1, -1), t[:, None, None, None] * own], dim=1)
    torch.testing.assert_close(found, expected.expand(2, -1, -1, -1, -1), rtol=1e-3, atol=1e-3)


def test_known_noise_is_found_again_to_a_tenth_and_nine_tenths_are_covered():
    generator = torch_generator(1)
    clips, steps = 400, 8
    path = along(straight, start(clips, 1), steps)
    off = 0.03 * torch.randn(clips, 1, 1, 2, generator=generator)
    t = torch.arange(1.0, steps + 1)[:, None, None]
    missed = off * t + 0.05 * torch.randn(clips, steps, 1, 2, generator=generator)
    made = Spread()
    made.fit(path, missed, rounds=50)
    cov = made(path)
    true = 0.05**2 + (0.03 * torch.arange(1.0, steps + 1)) ** 2
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), true.sqrt(), rtol=0.1, atol=0)
    inside = (squared_mahalanobis(missed, cov) < SURE).float().mean()
    assert inside.item() == pytest.approx(0.9, abs=0.005)


@pytest.mark.parametrize("power", [0.5, 2.0])
def test_what_else_grows_as_a_power_of_time_is_found_again_to_a_tenth_and_covered(power):
    """2: the law's own error for good, an acceleration."""
    clips, steps = 400, 24
    path = along(straight, start(clips, 1), steps)
    true = 0.002 * torch.arange(1.0, steps + 1) ** power
    missed = true[:, None, None] * torch.randn(clips, steps, 1, 2, generator=torch_generator(3))
    made = Spread()
    made.fit(path, missed, rounds=50)
    cov = made(path)
    torch.testing.assert_close(cov[0, :, 0, 0, 0].sqrt(), true, rtol=0.1, atol=0)
    inside = (squared_mahalanobis(missed, cov) < SURE).float().mean(dim=(0, 2))
    assert (inside - 0.9).abs().max() < 0.06  # four standard errors of 400 clips


def test_lost_tracks_do_not_rule_the_fit():
    path = torch.eye(4).unflatten(1, (2, 2))[:, :1].expand(100, 4, 4, 1, 2)
    missed = 0.02 * torch.randn(100, 4, 1, 2, generator=torch_generator(2))
    missed[:3] += 1.0
    made = Spread()
    made.fit(path, missed, rounds=50)
    std = made(path)[0, -1, 0, 0, 0].sqrt().item()
    assert std == pytest.approx(0.02, rel=0.15)


def test_nine_tenths_are_covered_near_and_far_though_misses_are_not_gaussian():
    """Few large misses and many small ones, as after collisions, growing as no part of the model does."""
    clips, steps = 600, 24
    path = along(straight, start(clips, 1), steps)
    t = torch.arange(1.0, steps + 1)
    generator = torch_generator(6)
    rare = torch.where(torch.rand(clips, 1, 1, 1, generator=generator) < 0.15, 6.0, 1.0)
    missed = (0.001 * t**0.7)[:, None, None] * rare * torch.randn(clips, steps, 1, 2, generator=generator)
    made = Spread()
    made.fit(path, missed, rounds=50)
    inside = (squared_mahalanobis(missed, made(path)) < SURE).float()
    for frames in (slice(0, 8), slice(8, 16), slice(16, 24)):
        assert inside[:, frames].mean().item() == pytest.approx(0.9, abs=0.03)
