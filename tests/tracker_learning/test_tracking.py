"""The tracker learns a small world without labels, owns up where nothing moves, and survives a kill."""

import numpy as np
import pytest
import torch
import worlds
from small_tracker import orbits, params

from physpipe.core.determinism import ComputeParams
from physpipe.core.errors import InputError
from physpipe.core.objects import ObjectsParams
from physpipe.io import results, tracks
from physpipe.metrics import trackers as metrics
from physpipe.tracker_learning import saving
from physpipe.tracker_learning.first import learn_first
from physpipe.tracker_learning.lesson import Lesson
from physpipe.tracker_learning.moments import MomentSampler
from physpipe.tracker_learning.others import learn_others
from physpipe.trackers import detectors
from physpipe.trackers.learned import LearnedTracker
from physpipe.trackers.tables import track_tables
from physpipe.tracknet.signals import locked

COMPUTE = ComputeParams(seed=0, threads=1)


def test_a_rolling_ball_is_found_without_labels_and_the_verdict_says_so(tmp_path):
    clips, truth = orbits(tmp_path / "clips")
    learned = learn_first(clips, params(steps=100, warm=60, rest=100), COMPUTE, tmp_path / "scratch")
    tracker = LearnedTracker(learned.net.detector, params(1, 1).tracking.readout)
    errors = [np.linalg.norm(tracker.track(clips.frames(n)).xy - truth[n][:, 0], axis=1) for n in clips.names("test")]
    assert np.mean(errors) < 1.5  # pixels, of a ball 6 px wide and cells 4 px wide
    assert locked(learned.signals, params(1, 1).lock)


def test_a_training_that_spoils_the_chosen_start_is_not_kept(tmp_path, monkeypatch):
    clips, _ = orbits(tmp_path / "clips")
    recipe, run = params(steps=100, warm=60, rest=1), Lesson.run

    def spoiling(self, net, fit, seed, checkpoint, what):
        curve = run(self, net, fit, seed, checkpoint, what)
        if what == "rest":
            for weights in net.parameters():
                weights.data.zero_()
        return curve

    monkeypatch.setattr(Lesson, "run", spoiling)
    learned = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    assert locked(learned.signals, recipe.lock)
    assert any(learned.net is start for start in learned.starts)


def test_two_balls_are_found_one_after_the_other(tmp_path):
    clips, truth = orbits(tmp_path / "clips", (worlds.RED, worlds.BLUE))
    recipe = params(steps=100, warm=60, rest=100)
    first = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    others = learn_others(clips, first.net, ObjectsParams(objects=2), recipe, COMPUTE, tmp_path / "scratch")
    tracker = detectors.together([first.net, *(each.net for each in others)], recipe.tracking)
    for name in clips.names("test"):
        found = np.stack([each.xy for each in tracker.track_all(clips.frames(name))], axis=1)
        apart = np.linalg.norm(found[:, :, None] - truth[name][:, None], axis=-1).mean(0)  # (found, true) pixels
        assert min(apart[0, 0] + apart[1, 1], apart[0, 1] + apart[1, 0]) / 2 < 2.5


@pytest.mark.parametrize("colours", [(worlds.RED,), (worlds.RED, worlds.BLUE), (worlds.RED, worlds.RED)])
def test_all_balls_are_found_at_once_alike_or_not_their_number_not_given(tmp_path, colours):
    clips, truth = orbits(tmp_path / "clips", colours)
    recipe = params(steps=100, warm=60, rest=100, several=True)
    learned = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    none_given = ObjectsParams(objects=None)
    assert learn_others(clips, learned.net, none_given, recipe, COMPUTE, tmp_path / "scratch") == []
    table, _ = track_tables(clips, detectors.together([learned.net], recipe.tracking), none_given, None)
    for name in clips.names("test"):
        found = tracks.positions(table, name)
        assert found.shape == truth[name].shape
        errors = metrics.distance(metrics.match(found, truth[name]), truth[name])
        assert np.nanmean(errors) < 1.5  # pixels
        assert np.isfinite(errors).mean() > 0.95
    assert locked(learned.signals, recipe.lock)


def test_a_ball_is_held_behind_a_post_and_beside_a_thing_that_never_moves(tmp_path):
    clips, truth = orbits(tmp_path / "clips", post=True)
    recipe = params(steps=100, warm=60, rest=100, several=True)
    learned = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    table, _ = track_tables(
        clips, detectors.together([learned.net], recipe.tracking), ObjectsParams(objects=None), None
    )
    for name in clips.names("test"):
        errors = metrics.distance(tracks.positions(table, name), truth[name])
        assert errors.shape[1] == 1
        assert np.nanmean(errors) < 2  # pixels
        assert np.isfinite(errors).mean() > 0.8


def test_masking_one_after_the_other_has_to_know_how_many(tmp_path):
    clips, _ = orbits(tmp_path / "clips")
    recipe = params(steps=1, warm=1, rest=1)
    first = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    with pytest.raises(InputError, match="empty, but sequential masking has to know"):
        learn_others(clips, first.net, ObjectsParams(objects=None), recipe, COMPUTE, tmp_path / "scratch")


def test_more_objects_than_slots_are_refused(tmp_path):
    clips, _ = orbits(tmp_path / "clips")
    recipe = params(steps=1, warm=1, rest=1, several=True)
    first = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    with pytest.raises(InputError, match="asks for 4; the detector finds 3"):
        learn_others(clips, first.net, ObjectsParams(objects=4), recipe, COMPUTE, tmp_path / "scratch")


def test_more_objects_than_move_are_refused(tmp_path):
    clips, _ = orbits(tmp_path / "clips")
    recipe = params(steps=100, warm=60)
    first = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    with pytest.raises(InputError, match=r"asks for more than 1 objects; beside the first 1 only .* of the motion"):
        learn_others(clips, first.net, ObjectsParams(objects=2), recipe, COMPUTE, tmp_path / "scratch")


@pytest.mark.parametrize("several", [False, True])
def test_a_still_film_that_only_gets_brighter_is_not_locked_on(tmp_path, several):
    rng = np.random.default_rng(0)
    ground = rng.uniform(60, 120, (worlds.HEIGHT, worlds.WIDTH, 3))
    ramp = np.linspace(0.8, 1.3, 24)[:, None, None, None]
    films = [(ground * ramp + rng.normal(0, 2, (24, *ground.shape))).clip(0, 255).astype(np.uint8) for _ in range(10)]
    clips = worlds.save_clips(tmp_path / "clips", films)
    recipe = params(steps=60, warm=30, several=several)
    learned = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    assert not locked(learned.signals, recipe.lock)


def test_a_killed_training_goes_on_to_the_same_weights(tmp_path, monkeypatch):
    clips, _ = orbits(tmp_path / "clips")
    recipe = params(steps=40, warm=20)
    whole = learn_first(clips, recipe, COMPUTE, tmp_path / "whole")

    class Killed(BaseException):
        pass

    draws = iter(range(70))

    def dies(self, generator, draw=MomentSampler.__call__):
        if next(draws, None) is None:
            raise Killed
        return draw(self, generator)

    with monkeypatch.context() as patch:
        patch.setattr(MomentSampler, "__call__", dies)
        with pytest.raises(Killed):
            learn_first(clips, recipe, COMPUTE, tmp_path / "killed")
    resumed = learn_first(clips, recipe, COMPUTE, tmp_path / "killed")
    for name, value in whole.net.state_dict().items():
        assert torch.equal(value, resumed.net.state_dict()[name]), name


def test_what_is_saved_is_what_was_learned(tmp_path):
    clips, _ = orbits(tmp_path / "clips")
    recipe = params(steps=5, warm=2, rest=5)
    learned = learn_first(clips, recipe, COMPUTE, tmp_path / "scratch")
    saving.save_first(tmp_path / "first", clips, learned, recipe)
    saving.save_all(tmp_path / "all", clips, tmp_path / "first", [learned], recipe)
    assert len(detectors.load(tmp_path / "first" / detectors.WEIGHTS)) == 1
    pair = detectors.load(tmp_path / "all" / detectors.WEIGHTS)
    name = clips.names("test")[0]
    table, _ = track_tables(clips, detectors.together(pair, recipe.tracking), ObjectsParams(objects=2), None)
    alone = LearnedTracker(learned.net.detector, recipe.tracking.readout).track(clips.frames(name))
    mine = table[(table["clip"] == name) & (table["object"] == 0)]
    np.testing.assert_array_equal(mine[["x", "y"]].to_numpy(), alone.xy)
    verdict = results.load_json(tmp_path / "all" / "verdict.json")
    assert verdict["locked"] == all(each["locked"] for each in verdict["objects"])
    assert len(verdict["objects"]) == 2


def test_an_unknown_recipe_is_refused_with_the_known_ones(tmp_path):
    clips, _ = orbits(tmp_path / "clips")
    with pytest.raises(InputError, match=r"no recipe `lok`.*small"):
        learn_first(clips, params(1, 1).model_copy(update={"recipe": "lok"}), COMPUTE, tmp_path)
