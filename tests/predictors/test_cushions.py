"""Facts about walls along the frame's sides: those of mechanics."""

import pytest
import torch
from torch import Tensor

from physpipe.predictors.cushions import Cushions, near_side

WHOLE, CODE = 3, 2
SIDES = torch.tensor([[0.7, 0.5], [0.7, 0.5]])[None, None]
SPEED = 0.05


def cushions(restitution: float = 0.6) -> Cushions:
    made = Cushions(WHOLE, CODE)
    made.bounce.data = torch.tensor(restitution).logit()
    return made


def step(made: Cushions, place: Tensor, velocity: Tensor) -> tuple[Tensor, Tensor]:
    with torch.no_grad():
        impact = made(place, velocity, SIDES)
    return place + velocity + impact.moved, velocity + impact.push


@pytest.mark.parametrize("phase", [0.02, 0.4, 0.98])
@pytest.mark.parametrize("sign", [-1, 1])
def test_speed_away_over_speed_towards_is_the_restitution_whenever_in_a_frame_it_touches(phase, sign):
    place = sign * torch.tensor([0.7 - (1 + phase) * SPEED, 0.0])[None, None, None]
    velocity = sign * torch.tensor([SPEED, 0.01])[None, None, None]
    for _ in range(5):
        place, velocity = step(cushions(), place, velocity)
    torch.testing.assert_close(velocity[0, 0, 0], sign * torch.tensor([-0.6 * SPEED, 0.01]))
    since = 5 - 1 - phase  # frames since it touched
    expected = sign * torch.tensor([0.7 - since * 0.6 * SPEED, 0.05])
    torch.testing.assert_close(place[0, 0, 0], expected, rtol=0, atol=1e-4)


def test_a_corner_turns_along_both_axes():
    _, velocity = step(cushions(), torch.tensor([0.69, 0.49])[None, None, None], torch.full((1, 1, 1, 2), SPEED))
    torch.testing.assert_close(velocity, torch.full((1, 1, 1, 2), -0.6 * SPEED))


def test_what_does_not_reach_a_side_or_leaves_it_is_not_pushed():
    places = torch.tensor([[0.6, 0.0], [0.71, 0.0], [0.0, -0.44]])[None, None]
    velocities = torch.tensor([[0.09, 0.0], [-0.03, 0.0], [0.3, -0.05]])[None, None]
    impact = cushions()(places, velocities, SIDES.expand(1, 3, -1, -1))
    assert torch.cat(list(impact)).abs().max() == 0


def test_it_slides_by_the_share_of_the_push_that_spins_it_not():
    made = cushions()
    made.spin.data = torch.tensor(0.75).logit()
    impact = made(torch.tensor([0.68, 0.0])[None, None, None], torch.full((1, 1, 1, 2), SPEED), SIDES)
    torch.testing.assert_close(impact.slid, 0.75 * impact.push)


def test_large_objects_turn_earlier_at_every_side():
    made = cushions()
    made.size.weight.data = torch.tensor([[0.1, 0.0]])
    where = made.where(torch.zeros(1, WHOLE), torch.tensor([[[1.0, 0], [0, 0]]]))
    assert (where[0, 0] < where[0, 1]).all()


def test_sides_are_where_tracks_turn_and_cushions_are_where_they_turn_at_once():
    """Film of balls on a table of 0.7 by 0.4, and of balls on springs that come as far out."""
    time, phase = torch.arange(60), 10 * torch.rand(64, 2, generator=torch.Generator().manual_seed(0))
    angle = (phase[:, None] + 0.09 * time[:, None]) % 4
    half = torch.tensor([0.7, 0.4])
    table = half * (torch.where(angle < 2, angle, 4 - angle) - 1)
    bowl = half * torch.cos(torch.pi / 2 * (phase[:, None] + 0.09 * time[:, None]))
    for track, present in ((table, True), (bowl, False)):
        made = cushions()
        optimiser = torch.optim.Adam(made.parameters(), lr=4e-3)
        for _ in range(400):
            optimiser.zero_grad()
            sides = made.where(torch.ones(64, WHOLE), torch.zeros(64, 1, CODE))
            made.see(track.unsqueeze(2), sides).backward()
            optimiser.step()
        torch.testing.assert_close(sides[0, 0], half.expand(2, 2), rtol=0, atol=0.03)
        assert made.present is present
        assert near_side(track.unsqueeze(2), sides).float().mean() < 0.5


def test_gradients_are_finite_at_rest_and_on_the_side():
    made = cushions()
    places = torch.tensor([[0.0, 0.0], [0.7, 0.5], [0.9, 0.0]])[None, None].requires_grad_()
    velocities = torch.tensor([[0.0, 0.0], [0.0, 0.1], [0.1, 0.0]])[None, None].requires_grad_()
    impact = made(places, velocities, SIDES.expand(1, 3, -1, -1))
    (impact.push.sum() + impact.moved.square().sum()).backward()
    assert all(torch.isfinite(each.grad).all() for each in (places, velocities, made.bounce))
