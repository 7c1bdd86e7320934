"""Facts about the track table of a data set by the learned tracker."""

import numpy as np
import pytest
import worlds
from pandas.testing import assert_frame_equal

from physpipe.core.objects import ObjectsParams
from physpipe.io import tracks
from physpipe.trackers.base import Trajectory
from physpipe.trackers.joint import PeakTracker
from physpipe.trackers.look import RefineParams
from physpipe.trackers.tables import track_tables

REFINE = RefineParams(
    rounds=2,
    reach_px=8,
    search_px=3,
    extent=1.35,
    least_fit=0.5,
    object_part=0.85,
    ground_part=(1.3, 2.2),
    least_radius_px=1.5,
)
T, CLIPS = 16, 5


class Told(PeakTracker):
    """Finds what the test says, in the order in which it says it."""

    def __init__(self, found: dict[bytes, list[Trajectory]]):
        self.found = found

    def track_all(self, frames, objects=None, ignore=None):
        return self.found[np.array(frames[0]).tobytes()]


@pytest.fixture
def world(tmp_path):
    """Clips of a red and a blue ball; the tracker names them in an order that changes from clip to clip, 1 px off."""
    truth, films, found = [], [], {}
    for number in range(CLIPS):
        xy = np.stack([worlds.orbit(T, number), worlds.orbit(T, number + np.pi)], axis=1)
        film = worlds.draw(xy, [worlds.RED, worlds.BLUE], seed=number)
        order = [0, 1] if number % 2 else [1, 0]
        doubtful = np.arange(T) == 3
        each = [Trajectory((xy[:, k] + 0.7).astype(np.float32), np.full(T, 0.5, np.float32), doubtful) for k in order]
        truth.append(xy)
        films.append(film)
        found[film[0].tobytes()] = each
    return worlds.save_clips(tmp_path / "clips", films), truth, Told(found)


def test_tracks_do_not_depend_on_how_many_clips_are_tracked_at_once(world, monkeypatch):
    clips, _, tracker = world
    tables = []
    for workers in ("1", "3"):
        monkeypatch.setenv("PHYSPIPE_WORKERS", workers)
        tables.append(track_tables(clips, tracker, ObjectsParams(objects=2), REFINE)[0])
    assert_frame_equal(*tables)


def test_an_object_has_the_same_number_in_all_clips_as_its_colour_tells(world):
    clips, truth, tracker = world
    _, before = track_tables(clips, tracker, ObjectsParams(objects=None), None)
    orders = set()
    for name, xy in zip(clips.names(), truth, strict=True):
        apart = np.linalg.norm(tracks.positions(before, name)[:, :, None] - xy[:, None], axis=-1).mean(axis=0)
        orders.add(tuple(apart.argmin(axis=1).tolist()))
    assert orders in ({(0, 1)}, {(1, 0)})


def test_the_table_before_refinement_is_kept_and_refinement_is_nearer(world):
    clips, truth, tracker = world
    after, before = track_tables(clips, tracker, ObjectsParams(objects=2), REFINE)
    name, xy = clips.names()[0], truth[0]

    def worst(table):
        apart = np.linalg.norm(tracks.positions(table, name)[:, :, None] - xy[:, None], axis=-1)
        return apart.min(axis=2).mean()

    assert worst(before) == pytest.approx(0.7 * np.sqrt(2), abs=1e-3)  # pixels
    assert worst(after) < 0.4


def test_doubts_are_in_the_status(world):
    clips, _, tracker = world
    table, _ = track_tables(clips, tracker, ObjectsParams(objects=2), None)
    assert sorted(set(table.loc[table["status"] == tracks.AMBIGUOUS, "frame"])) == [3]


@pytest.mark.parametrize(("given", "expected"), [(None, 2), (1, 1), (3, 3)])
def test_every_clip_has_the_number_of_objects_that_is_given_or_that_most_clips_show(world, given, expected):
    clips, _, tracker = world
    one_short = clips.frames(clips.names()[2])[0].tobytes()
    tracker.found[one_short] = tracker.found[one_short][:1]
    table, _ = track_tables(clips, tracker, ObjectsParams(objects=given), None)
    assert set(table.groupby("clip")["object"].nunique()) == {expected}
    lost = table[(table["clip"] == clips.names()[2]) & (table["object"] == expected - 1)]
    if expected > 1:
        assert tracks.positions(table, clips.names()[2]).shape == (T, expected, 2)
        assert set(lost["status"]) <= {"lost", "tracked", tracks.AMBIGUOUS}
