"""Facts about what the predictors share of motion."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.kinematics import CHANGE, POWERS, SPEED, at, change, mended, past, slope, smoothed

TIMES = torch.arange(4.0).expand(2, -1)


def seen_places() -> torch.Tensor:
    """(2, 4, 3, 2)."""
    return torch.randn(2, 4, 3, 2, generator=torch_generator(0))


def test_the_slope_of_a_line_is_its_own_whatever_the_times():
    times = torch.tensor([[0.0, 1.0, 4.0], [2.0, 3.0, 9.0]])
    places = times[..., None, None] * torch.tensor([0.5, -2.0])
    torch.testing.assert_close(slope(places, times), torch.tensor([0.5, -2.0]).expand(2, 1, 2))


def test_with_nothing_to_mend_motion_begins_at_the_last_place_along_the_slope():
    places = seen_places()
    place, displacement = mended(torch.zeros(2, 3, 10), places, TIMES)
    torch.testing.assert_close(place, places[:, -1])
    torch.testing.assert_close(displacement, slope(places, TIMES))


def test_a_law_of_friction_and_gravity_changes_a_displacement_so():
    law = torch.zeros(2, POWERS)  # for x and y: 1, x, y, x^2, x y, y^2
    law[1, 0] = 3.0
    law[0, 1] = law[1, 2] = -2.0
    found = change(law.flatten(), torch.tensor([4 * SPEED, -SPEED]))
    torch.testing.assert_close(found, CHANGE * torch.tensor([-8.0, 3.0 + 2.0]))


def test_the_law_turns_with_the_square_of_the_speed():
    law = torch.zeros(2, POWERS)
    law[0, 3], law[0, 4], law[1, 5] = 1.0, 10.0, 100.0
    found = change(law.flatten(), torch.tensor([2 * SPEED, 3 * SPEED]))
    torch.testing.assert_close(found, CHANGE * torch.tensor([4.0 + 60.0, 900.0]))


def test_what_is_read_of_the_past_is_each_object_s_own():
    places = seen_places()
    other = places.clone()
    other[:, :, 1] += 1
    differs = (past(other) != past(places)).any(2)
    assert differs.tolist() == [[False, True, False]] * 2
    assert past(places).shape == (2, 3, 16)


def test_a_path_is_looked_up_by_frames_ahead():
    path = torch.arange(10.0).reshape(2, 5, 1)
    assert at(path, torch.tensor([[1, 5], [2, 2]])).flatten().tolist() == [0, 4, 6, 6]


def test_a_smoothed_parabola_is_itself_and_steps_on_exactly():
    """p += v + a leads from each place to the next."""
    times = torch.arange(13.0)[None, :, None, None]
    path = 3 + times * torch.tensor([0.5, -2.0]) + times**2 * torch.tensor([0.02, 0.1])
    place, step, turn = smoothed(path, frames=7)
    torch.testing.assert_close(place, path[:, 3:10], rtol=0, atol=1e-4)
    torch.testing.assert_close(step, path[:, 3:10] - path[:, 2:9], rtol=0, atol=1e-4)
    torch.testing.assert_close((place + step + turn)[:, :-1], place[:, 1:], rtol=0, atol=1e-4)


def test_smoothing_leaves_a_tenth_of_the_noise_of_second_differences():
    noise = torch.randn(50, 40, 1, 2, generator=torch_generator(1))
    rough = (noise[:, 2:] - 2 * noise[:, 1:-1] + noise[:, :-2]).std()
    assert smoothed(noise, frames=9)[2].std() < rough / 10


def test_a_short_path_is_smoothed_over_what_there_is():
    assert smoothed(torch.zeros(2, 8, 1, 2), frames=9)[0].shape == (2, 4, 1, 2)  # 5 of them


def test_of_a_path_no_more_than_two_thirds_are_smoothed_over():
    path = torch.zeros(1, 21, 1, 2)
    assert [smoothed(path, frames)[0].shape[1] for frames in (5, 9, 13, 27)] == [17, 13, 9, 9]
