import pytest
import torch
from torch import Tensor

from physpipe.predictors.base import Seen
from physpipe.predictors.polynomial import Linear, NoParams, Persistence, Quadratic

OBJECTS = 3
FALL_PX = 0.2
"""Half of the acceleration, per frame squared."""


def thrown(times: Tensor) -> Tensor:
    """(2, T, K, 2) px: start + v t + 0.2 t^2, the last downwards, in two clips."""
    generator = torch.Generator().manual_seed(0)
    start = 100 * torch.rand(2, 1, OBJECTS, 2, generator=generator)
    velocity = torch.rand(2, 1, OBJECTS, 2, generator=generator) - 0.5
    t = times.float().reshape(1, -1, 1, 1)
    return start + velocity * t + torch.tensor([0.0, FALL_PX]) * t**2


def error(kind: type, seen: list[int], asked: list[int]) -> Tensor:
    """(2, N, K, 2) px by which `kind` misses the stones."""
    known, wanted = torch.tensor(seen), torch.tensor(asked)
    film = torch.zeros(2, len(seen), 3, 20, 28)
    forecast = kind(NoParams(), OBJECTS)(
        Seen(film, thrown(known), known.float().expand(2, -1)), wanted.float().expand(2, -1)
    )
    assert forecast.cov is None
    return forecast.mean - thrown(wanted)


@pytest.mark.parametrize(("seen", "asked"), [(range(10), range(10, 41)), ([0, 1, 10, 11], range(2, 10))])
def test_a_parabola_is_exact_in_free_fall_ahead_and_between(seen, asked):
    assert error(Quadratic, list(seen), list(asked)).abs().max() < 1e-3  # px


def test_a_line_misses_exactly_the_fall():
    missed = error(Linear, seen=[0, 1], asked=list(range(2, 9)))  # the line through frames 0 and 1
    t = torch.arange(2, 9)[:, None]
    torch.testing.assert_close(missed[..., 0], torch.zeros(2, 7, OBJECTS), rtol=0, atol=1e-3)
    fall = (FALL_PX * t * (t - 1)).expand(2, 7, OBJECTS)
    torch.testing.assert_close(-missed[..., 1], fall, rtol=0, atol=1e-3)


def test_persistence_stays_at_the_last_seen_position():
    missed = error(Persistence, seen=[0, 1, 2, 3], asked=[4, 9])
    expected = thrown(torch.tensor([3, 3])) - thrown(torch.tensor([4, 9]))
    torch.testing.assert_close(missed, expected, rtol=0, atol=1e-5)


def test_polynomials_see_ten_frames_and_persistence_four():
    assert [kind.seen_frames for kind in (Linear, Quadratic, Persistence)] == [10, 10, 4]
