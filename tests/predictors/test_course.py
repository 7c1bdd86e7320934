"""Facts about what the tracks of whole clips teach."""

import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors.course import Course, stretches
from physpipe.predictors.terrain_law import Law, Scene

FRAMES = 40
FALL = torch.tensor([0.0, 0.002])
"""Change of velocity a frame."""


def law() -> Law:
    """Of free flight, until it has learned anything."""
    torch.manual_seed(0)
    return Law(channels=16, whole=16, code=2, hidden=8, pairs=False)


def scene(clips: int) -> Scene:
    """Ground that says nothing, on a frame that is wider than high."""
    codes = torch.zeros(clips, 1, 2)
    return Scene(torch.zeros(clips, 16, 5, 6), torch.zeros(clips, 16), codes, torch.tensor([2.0, 1.7]))


def falling(clips: int) -> torch.Tensor:
    """(B, L, 1, 2) parabolas, each from a place of its own."""
    times = torch.arange(float(FRAMES))[:, None, None]
    first = 0.1 * torch.randn(clips, 1, 1, 2, generator=torch_generator(0))
    return first + torch.tensor([0.01, -0.02]) * times + FALL * times * (times - 1) / 2


def course(track: torch.Tensor) -> Course:
    return Course.of(track, 7, law(), scene(len(track)))


def test_free_flight_misses_a_fall_by_how_strong_it_is_at_every_known_moment():
    track = falling(3)
    off = course(track).mismatch(law(), scene(3), torch.tensor(64.0))
    torch.testing.assert_close(off, 64 * FALL.norm(), rtol=0, atol=2e-3)  # px a frame squared
    track[0, 20] = torch.nan
    track[1, 30:] = torch.nan
    torch.testing.assert_close(course(track).mismatch(law(), scene(3), torch.tensor(64.0)), off, rtol=0, atol=1e-4)


def test_a_moment_that_is_smoothed_over_a_lost_frame_teaches_nothing():
    track = falling(1)
    track[0, 20] = torch.nan
    lost = [at for at in range(FRAMES - 6) if at <= 20 < at + 7]
    assert (course(track).free[0] == 0).nonzero().flatten().tolist() == lost


def test_stretches_are_parts_of_the_track():
    track = falling(2)
    found = stretches(track, 14, 50, torch_generator(0))
    assert found.shape == (2, 50, 14, 1, 2)
    every = track.unfold(1, 14, 1).movedim(-1, 2)  # (2, 27, 14, 1, 2)
    same = (found.unsqueeze(2) == every.unsqueeze(1)).flatten(3).all(3)  # (2, 50, 27)
    assert (same.sum(2) == 1).all()
    assert (same.any(1).sum(1) > 15).all()  # of 27


def test_no_stretch_holds_a_lost_frame():
    track = falling(2)
    track[0, 25] = torch.nan
    track[1, 14:] = torch.nan
    found = stretches(track, 14, 50, torch_generator(0))
    assert found[0].isfinite().all()
    assert torch.equal(found[1], track[1, :14].expand(50, -1, -1, -1))


def test_unknown_places_leave_every_gradient_finite():
    track = falling(1)
    track[0, 20] = torch.nan
    learner = law()
    Course.of(track, 7, learner, scene(1)).mismatch(learner, scene(1), torch.tensor(64.0)).backward()
    assert all(each.grad.isfinite().all() for each in learner.parameters() if each.grad is not None)
