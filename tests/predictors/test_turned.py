"""Facts about paths that a wall has turned: those of mechanics, on a frame that is wider than high."""

import pytest
import torch
from torch import Tensor

from physpipe.core.determinism import torch_generator
from physpipe.predictors.turned import unfolded

WALLS = {"left": (0, 0), "up": (0, 1), "right": (1, 0), "down": (1, 1)}
SIDES = torch.tensor([[0.8, 0.5], [0.78, 0.52]])
KEPT = 0.7
PX = 1 / 64  # of a frame 128 px wide, in halves of it


def bounced(wall: str, moment: float, speed: float, shifted: float = 0.0, frames: int = 4) -> tuple[Tensor, Tensor]:
    """(1, T, 1, 2) places of a ball that reaches a wall `moment` frames after the first, and (2,) its last velocity.

    The wall is `shifted` outwards from where SIDES has it.
    """
    side, axis = WALLS[wall]
    sign, time = (-1, 1)[side], torch.arange(frames) - moment
    out = SIDES[side, axis] + shifted - speed * torch.where(time < 0, -time, KEPT * time)
    along = 0.1 + 0.02 * torch.arange(frames)
    path, last = [along, along], torch.full((2,), 0.02)
    path[axis], last[axis] = sign * out, -sign * KEPT * speed
    return torch.stack(path, dim=-1)[None, :, None], last


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("moment", [0.4, 0.9, 1.5, 2.4])
@pytest.mark.parametrize("shifted", [-PX, 0, 1.5 * PX])
def test_a_path_that_was_turned_is_straight_in_the_mirror_and_as_fast_as_it_ended(wall, moment, shifted):
    places, velocity = bounced(wall, moment, 0.06, shifted)
    found = unfolded(places, SIDES[None, None], torch.tensor(KEPT))
    expected = places[:, -1:] + velocity * torch.arange(-3.0, 1)[:, None, None]
    torch.testing.assert_close(found.places, expected, rtol=0, atol=0.35 * PX)  # a wall seen elsewhere is half believed
    torch.testing.assert_close(found.places[:, -1], places[:, -1])
    side, axis = WALLS[wall]
    assert found.touched[0, 0, axis]
    assert not found.touched[0, 0, 1 - axis]
    assert found.push[0, 0, 1 - axis] == 0
    assert found.push[0, 0, axis].item() == pytest.approx((1, -1)[side] * (1 + KEPT) * 0.06, abs=0.4 * PX)


def test_both_walls_of_a_corner_are_seen():
    one, by_one = bounced("right", 0.6, 0.06)
    other, by_other = bounced("up", 1.7, 0.05)
    found = unfolded(torch.cat([one[..., :1], other[..., 1:]], dim=-1), SIDES[None, None], torch.tensor(KEPT))
    velocity = torch.stack([by_one[0], by_other[1]])
    assert found.touched.all()
    torch.testing.assert_close(found.places.diff(dim=1)[0, :, 0], velocity.expand(3, 2), rtol=0, atol=1e-3)


@pytest.mark.parametrize("distance", [0.5, 2, 8, 20])
def test_nothing_is_seen_where_nothing_was_touched_whatever_the_noise_of_the_track(distance):
    """Balls that run along a wall, up to it or away from it, noise 0.3 px."""
    generator = torch_generator(0)
    away = 0.05 * torch.rand(500, 1, 1, generator=generator) * torch.arange(4)[:, None]
    out = SIDES[1, 0] - distance * PX - torch.cat([away, away.flip(1), 0 * away])
    places = torch.stack([out, 0.1 * torch.ones_like(out)], dim=-1)
    places = places + 0.3 * PX * torch.randn(places.shape, generator=generator)
    found = unfolded(places, SIDES[None, None].expand(1500, -1, -1, -1), torch.tensor(KEPT))
    assert found.touched.float().mean() < 0.01
    untouched = ~found.touched.any(-1).squeeze(-1)
    torch.testing.assert_close(found.places[untouched], places[untouched])


def test_what_turns_by_and_by_was_not_touched():
    """A ball on a slope that turns at the wall's place, slowed by 0.4 px a frame squared."""
    time = torch.arange(4) - 1.5
    out = SIDES[1, 0] - 0.2 * PX * time.square()
    places = torch.stack([out, 0.1 + 0.02 * time], dim=-1)[None, :, None]
    found = unfolded(places, SIDES[None, None], torch.tensor(KEPT))
    assert not found.touched.any()
    torch.testing.assert_close(found.places, places)


def test_objects_are_seen_one_by_one_each_with_its_own_sides():
    one, other = bounced("right", 1.5, 0.06)[0], bounced("right", 1.5, 0.06, shifted=-6 * PX)[0]
    sides = torch.stack([SIDES, SIDES.clone()])
    sides[1, 1, 0] -= 6 * PX
    found = unfolded(torch.cat([one, other], dim=2), sides[None], torch.tensor(KEPT))
    assert found.touched[0, :, 0].all()
    apart = (found.places[0, :, 0] - found.places[0, :, 1])[:, 0]
    torch.testing.assert_close(apart, torch.full((4,), 6 * PX), rtol=0, atol=1e-5)


def test_the_restitution_can_be_learned_from_it():
    places, velocity = bounced("down", 1.3, 0.06)
    kept = torch.tensor(0.5, requires_grad=True)
    found = unfolded(places, SIDES[None, None], kept)
    (found.places.diff(dim=1)[0, :, 0] - velocity).square().sum().backward()
    assert kept.grad is not None
    assert kept.grad < 0  # it is larger
