"""Facts about all objects found in one pass."""

import math

import numpy as np
import pytest
import torch
import worlds

from physpipe.trackers.joint import PeakTracker
from physpipe.trackers.learned import LearnedTracker, ReadoutParams
from physpipe.trackers.linking import LinkParams
from physpipe.trackers.look import RefineParams
from physpipe.tracknet.places import PeakParams

T = 24
LINKS = LinkParams(
    gate_px=8,
    apart_px=3,
    memory_frames=10,
    least_share=0.3,
    doubt_px=3,
    search_px=5,
    look_frames=10,
    speed_frames=2,
    still_px=2,
)
REFINE = RefineParams(
    rounds=2,
    reach_px=8,
    search_px=3,
    extent=1.3,
    least_fit=0.5,
    object_part=0.85,
    ground_part=(1.3, 2.2),
    least_radius_px=1.5,
)


class Colourfulness(torch.nn.Module):
    """A detector by hand: how far each cell is from grey."""

    stride = 4

    def forward(self, frames: torch.Tensor) -> torch.Tensor:
        return 12 * torch.nn.functional.avg_pool2d((frames[:, :1] - frames[:, 2:]).abs(), 4)[:, 0]


def tracker(least_mass: float, refinement: RefineParams | None = REFINE) -> PeakTracker:
    several = PeakParams(slots=3, apart_px=8, window_px=7, least_mass=least_mass, even=0.1, nearby_cells=5)
    detector = LearnedTracker(Colourfulness(), ReadoutParams(window_px=9, batch_frames=7))
    return PeakTracker(detector, several, LINKS, refinement)


def two_balls() -> tuple[np.ndarray, np.ndarray]:
    xy = np.stack([worlds.orbit(T, 0.0), worlds.orbit(T, math.pi)], axis=1)
    return worlds.draw(xy, [worlds.RED, worlds.BLUE], seed=0), xy


def test_both_balls_are_found_unless_fewer_are_asked_for():
    frames, xy = two_balls()
    found = tracker(0.1).track_all(frames)
    assert len(found) == 2
    assert len(tracker(0.1).track_all(frames, objects=1)) == 1
    for each in found:
        assert np.linalg.norm(each.xy[:, None] - xy, axis=-1).mean(axis=0).min() < 1.5  # pixels


def test_what_is_ignored_is_not_found():
    frames, xy = two_balls()
    rows, columns = np.mgrid[: worlds.HEIGHT, : worlds.WIDTH]
    ignore = np.hypot(columns - xy[:, 0, 0, None, None], rows - xy[:, 0, 1, None, None]) < 7
    found = tracker(0.2, refinement=None).track_all(frames, ignore=ignore)
    assert len(found) == 1
    assert np.linalg.norm(found[0].xy - xy[:, 1], axis=1).mean() < 2  # pixels


@pytest.mark.parametrize("refinement", [None, REFINE])
def test_where_no_track_can_be_made_the_highest_peak_stands_in_and_is_ambiguous(refinement):
    frames, xy = two_balls()
    (only,) = tracker(0.99, refinement).track_all(frames)
    assert only.ambiguous is not None
    assert only.ambiguous.all()
    nearest = np.linalg.norm(only.xy[:, None] - xy, axis=-1).min(axis=1)
    assert nearest.max() < 2.5  # pixels: on one ball or the other


def test_a_ball_that_goes_undetected_for_a_while_is_followed_by_its_look(monkeypatch):
    frames, xy = two_balls()
    whole = tracker(0.1)
    detect, hidden = whole.detect, range(8, 14)

    def blinded(frames, ignore=None):
        places, masses = detect(frames, ignore)
        for frame in hidden:
            masses[frame, np.linalg.norm(places[frame] - xy[frame, 0], axis=1) < 4] = 0
        return places, masses

    monkeypatch.setattr(whole, "detect", blinded)
    found = whole.track_all(frames)
    red = min(found, key=lambda each: np.linalg.norm(each.xy - xy[:, 0], axis=1).mean())
    assert np.linalg.norm(red.xy - xy[:, 0], axis=1)[list(hidden)].max() < 1.5  # pixels
