"""Facts about two objects that meet: those of mechanics."""

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.contact import REACH, RESTITUTION, Contact

GROUND, CODE = 4, 3


def contact(restitution: float = RESTITUTION) -> Contact:
    torch.manual_seed(0)
    made = Contact(GROUND, CODE, hidden=8)
    made.bounce.data = torch.tensor(restitution).logit()
    return made


def learned() -> Contact:
    """One whose pairs differ in every way."""
    made = contact()
    for each in made.parameters():
        each.data += 0.1 * torch.randn(each.shape, generator=torch_generator(1))
    return made


def met(
    made: Contact,
    places: list[tuple[float, float]],
    displacements: list[tuple[float, float]],
    slope: tuple[float, float] = (0, 0),
):
    K = len(places)
    generator = torch_generator(2)
    ground, codes = torch.randn(1, 1, K, K, GROUND, generator=generator), torch.randn(1, K, CODE, generator=generator)
    with torch.no_grad():
        slopes = torch.tensor([float(each) for each in slope]).expand(1, 1, K, K, 2)
        return made(torch.tensor([[places]]), torch.tensor([[displacements]]), ground, slopes, codes)


def test_equal_balls_that_meet_head_on_without_loss_swap_their_velocities():
    impact = met(contact(1 - 1e-6), [(0, 0), (REACH + 0.02, 0)], [(0.06, 0), (-0.02, 0)])
    after = torch.tensor([[0.06, 0.0], [-0.02, 0.0]]) + impact.push[0, 0]
    torch.testing.assert_close(after, torch.tensor([[-0.02, 0.0], [0.06, 0.0]]), rtol=0, atol=1e-3)


def test_what_is_left_of_the_frame_after_the_touch_is_run_with_the_new_velocity():
    impact = met(contact(), [(0, 0), (REACH + 0.02, 0)], [(0.06, 0), (-0.02, 0)])  # touch after a quarter of it
    torch.testing.assert_close(impact.moved, 0.75 * impact.push, rtol=0, atol=2e-3)


def test_a_ball_slides_by_the_share_of_the_push_that_spins_it_not():
    made = contact()
    made.spin.data = torch.tensor(0.7).logit()
    impact = met(made, [(0, 0), (REACH + 0.02, 0)], [(0.06, 0), (-0.02, 0)])
    torch.testing.assert_close(impact.slid, 0.7 * impact.push)


@pytest.mark.parametrize("phase", [0.05, 0.3, 0.55, 0.8, 0.98])
@pytest.mark.parametrize("closing", [0.02, 0.05, 0.1])
def test_speed_of_parting_over_speed_of_meeting_is_the_restitution_whenever_in_a_frame_they_touch(phase, closing):
    made, places = contact(0.6), torch.tensor([[0.0, 0.0], [REACH + (1 + phase) * closing, 0.0]])
    displacements = torch.tensor([[closing, 0.0], [0.0, 0.0]])
    for _ in range(6):
        impact = met(made, places.tolist(), displacements.tolist())
        places = places + displacements + impact.moved[0, 0]
        displacements = displacements + impact.push[0, 0]
    parting = (displacements[1, 0] - displacements[0, 0]).item()
    assert parting / closing == pytest.approx(0.6, abs=0.01)
    since = 6 - 1 - phase  # frames since they touched
    assert (places[1, 0] - places[0, 0] - REACH).item() == pytest.approx(since * parting, abs=0.01 * closing)


def test_the_heavier_object_is_pushed_less_and_momentum_stays():
    made = contact()
    generator = torch_generator(2)
    torch.randn(1, 1, 2, 2, GROUND, generator=generator)
    made.weight.weight.data = torch.randn(1, CODE, generator=torch_generator(5))
    mass = made.weight(torch.randn(1, 2, CODE, generator=generator)).exp()[0]
    push = met(made, [(0, 0), (REACH + 0.02, 0)], [(0.06, 0), (-0.02, 0)]).push[0, 0]
    assert abs(mass[0] / mass[1] - 1) > 0.2
    torch.testing.assert_close(mass[0] * push[0], -mass[1] * push[1])


def test_larger_objects_touch_from_further_away():
    made = contact()
    codes = torch.tensor([[[1.0, 0, 0], [1.0, 0, 0], [0, 0, 0]]])
    made.size.weight.data = torch.tensor([[0.1, 0.0, 0.0]])
    reaches = made.reaches(codes)[0]
    assert reaches[0, 1] > reaches[0, 2] > reaches[2, 2]
    assert reaches[2, 2].item() == pytest.approx(REACH)


def test_a_glancing_touch_pushes_along_the_line_between_the_middles():
    apart = REACH * torch.tensor([0.8, 0.6])
    impact = met(contact(), [(0, 0), tuple((apart + torch.tensor([0.001, 0])).tolist())], [(0.06, 0), (0, 0)])
    ahead = impact.push[0, 0, 1]
    assert (ahead[1] / ahead[0]).item() == pytest.approx(0.75, abs=0.02)


@pytest.mark.parametrize(
    ("places", "displacements"),
    [
        pytest.param([(0, 0), (1.5 * REACH, 0)], [(0.05, 0), (0, 0)], id="not this frame"),
        pytest.param([(0, 0), (0, 1.5 * REACH)], [(0.4, 0), (0, 0)], id="passing by"),
        pytest.param([(0, 0), (1.01 * REACH, 0)], [(-0.05, 0), (0, 0)], id="parting"),
    ],
)
def test_objects_that_do_not_meet_are_not_pushed(places, displacements):
    assert met(contact(), places, displacements).push.abs().max() < 1e-4


def test_unequal_objects_are_pushed_apart_and_the_pushes_are_opposite():
    impact = met(learned(), [(0, 0), (REACH, 0.01)], [(0.06, 0), (-0.02, 0)])
    one, other = impact.push[0, 0]
    assert one[0] < 0 < other[0]
    cosine = torch.nn.functional.cosine_similarity(one, other, dim=0)
    assert cosine.item() == pytest.approx(-1, abs=1e-5)


def test_of_three_only_those_that_meet_are_pushed():
    impact = met(contact(), [(0, 0), (0.9, 0.9), (REACH, 0)], [(0.06, 0), (0, 0), (0, 0)])
    assert impact.push[0, 0, 1].abs().max() < 1e-4
    assert impact.push[0, 0, 2, 0] > 0.02


def test_on_a_slope_balls_meet_as_in_space():
    """An elastic impact of equal balls on a plane that rises along y, worked out in three dimensions."""
    rise = 1.2
    made = contact(1 - 1e-6)
    line = torch.tensor([0.6, 0.8, 0.8 * rise], dtype=torch.float64)
    apart = 1.001 * REACH * line / line.norm()
    seen = torch.tensor([0.05, 0.03])
    impact = met(made, [(0, 0), (apart[0].item(), apart[1].item())], [tuple(seen.tolist()), (0, 0)], slope=(0, rise))
    velocity = torch.tensor([seen[0], seen[1], rise * seen[1]], dtype=torch.float64)
    along = line / line.norm()
    expected = (velocity @ along) * along[:2]
    torch.testing.assert_close(impact.push[0, 0, 1].double(), expected, rtol=0.02, atol=0)


def test_gradients_are_finite_however_objects_lie():
    made = contact()
    places = torch.tensor([[[[0.0, 0.0], [REACH, 0.0]]], [[[0.0, 0.0], [0.0, 0.0]]], [[[0.0, 0.0], [0.9, 0.0]]]])
    places.requires_grad_()
    displacements = torch.tensor([[[[0.05, 0.0], [0.0, 0.0]]], [[[0.0, 0.0]] * 2], [[[0.0, 0.0]] * 2]]).requires_grad_()
    ground, level = torch.zeros(3, 1, 2, 2, GROUND), torch.zeros(3, 1, 2, 2, 2)
    impact = made(places, displacements, ground, level, torch.zeros(3, 2, CODE))
    (impact.push.sum() + impact.moved.square().sum()).backward()
    assert all(torch.isfinite(each.grad).all() for each in (places, displacements, made.reach, made.bounce))


def test_the_reach_begins_where_objects_were_seen_to_come_nearest():
    made = contact()
    nearest = torch.full((64,), 0.37)
    nearest[0] = 0  # two tracks that coincide, by mistake
    for _ in range(600):
        made.see_distances(nearest)
    assert made.reach.exp().item() == pytest.approx(1.3 * 0.37, rel=1e-3)
