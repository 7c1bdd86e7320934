"""Learns the tracker: several short starts, the best goes on; then one detector more per object."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import torch
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.determinism import ComputeParams, device, torch_generator
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.io.clips import ClipSet, common_size
from physpipe.learning.moments import MomentParams, MomentSampler
from physpipe.learning.training import FitParams, fit
from physpipe.trackers.detectors import TrackingParams, together
from physpipe.trackers.learned import cells
from physpipe.trackers.sequential import SequentialTracker, hidden_by
from physpipe.trackers.tables import ObjectsParams
from physpipe.tracknet.model import TrackNet, TrackNetParams
from physpipe.tracknet.moments import Moments
from physpipe.tracknet.signals import LockParams, SignalParams, Signals, read_signals


class RecipeParams(Section):
    """One way to learn a detector."""

    net: TrackNetParams
    moments: MomentParams
    starts: int = Field(ge=1)
    """Short trainings from scratch, of which the one with the best unsupervised score goes on."""
    start: FitParams
    """Training of each start."""
    rest: FitParams
    """Training of the best start to its end, and of each further object's detector."""


class TrackerParams(Section):
    """The unsupervised tracker."""

    recipe: str
    """A key of `recipes`."""
    recipes: dict[str, RecipeParams]
    signals: SignalParams
    lock: LockParams
    tracking: TrackingParams
    least_motion: float = Field(ge=0, le=1)
    """Share of the motion that must be left outside the masks for there to be another object."""

    def chosen(self) -> RecipeParams:
        """The recipe to run; raises InputError for a name that is not in `recipes`."""
        if self.recipe not in self.recipes:
            raise InputError("tracker.recipe", f"no recipe `{self.recipe}`", f"use one of {sorted(self.recipes)}")
        return self.recipes[self.recipe]


@dataclass(frozen=True)
class Lesson:
    """Everything that a training of one detector needs beside the network."""

    train: MomentSampler
    held_out: list[Moments]
    signals: SignalParams

    def read(self, net: TrackNet) -> Signals:
        """Signals on the held-out batches; the same noise for every network and time."""
        with torch.autocast(device().type, torch.bfloat16):
            return read_signals(net.eval(), self.held_out, self.signals, torch_generator(0))

    def run(self, net: TrackNet, params: FitParams, seed: int, checkpoint: Path, what: str) -> pd.DataFrame:
        """Trains `net` and returns its curve; it is left with the weights of the best unsupervised score."""
        score = lambda: self.read(net).score(self.signals)  # noqa: E731
        curve = fit(net, self.train, score, params, seed, checkpoint, what)
        return curve.assign(phase=what)


@dataclass(frozen=True)
class Learned:
    """A trained network, how it got there, and what is known of it without labels."""

    net: TrackNet
    curve: pd.DataFrame
    signals: Signals
    starts: list[TrackNet]
    """The network at the end of each start, the chosen one included."""


Ignored = Mapping[str, NDArray[np.bool_]]


def lesson(clips: ClipSet, recipe: RecipeParams, signals: SignalParams, ignored: Ignored | None = None) -> Lesson:
    """Moments of the training clips to learn from and of the validation clips to judge by."""
    train = MomentSampler(clips, clips.names("train"), recipe.moments, recipe.rest.batch_size, ignored)
    valid = MomentSampler(clips, clips.names("valid"), recipe.moments, recipe.rest.batch_size, ignored)
    held_out = [valid(torch_generator(1, number)) for number in range(signals.batches)]
    return Lesson(train, held_out, signals)


def learn_first(clips: ClipSet, params: TrackerParams, compute: ComputeParams, scratch: Path) -> Learned:
    """T1: `starts` short trainings, then the rest of the training for the best of them."""
    recipe = params.chosen()
    task = lesson(clips, recipe, params.signals)
    nets, curves = [], []
    for number in range(recipe.starts):
        torch.manual_seed(int(torch.randint(2**31, (), generator=torch_generator(compute.seed, number))))
        net = TrackNet(recipe.net, max(common_size(clips)))
        seed = 1000 * compute.seed + number
        curves.append(task.run(net, recipe.start, seed, scratch / f"start{number}.pt", f"start {number}"))
        nets.append(net)
    scores = [task.read(each).score(params.signals) for each in nets]
    best = _copy(nets[int(np.argmin(scores))])
    curves.append(task.run(best, recipe.rest, 1000 * compute.seed + 999, scratch / "rest.pt", "rest"))
    return Learned(best, pd.concat(curves), task.read(best), nets)


def learn_others(
    clips: ClipSet,
    first: TrackNet,
    objects: ObjectsParams,
    params: TrackerParams,
    compute: ComputeParams,
    scratch: Path,
) -> list[Learned]:
    """T2 ... TK by sequential masking (paper section 3.1); none when T1 finds all objects at once.

    Raises InputError when the number of objects is needed and not given, or more than T1 can find.
    """
    key, count, several = "params.yaml: `objects` of this data set", objects.objects, first.params.peaks
    if several is not None:
        if count is not None and count > several.slots:
            raise InputError(key, f"asks for {count}; the detector finds {several.slots}", "raise `peaks.slots`")
        return []
    if count is None:
        raise InputError(key, "empty, but sequential masking has to know", "give it, or use `tracker.recipe: joint`")
    learned: list[Learned] = []
    while len(learned) + 1 < count:
        learned.append(learn_next(clips, [first, *(each.net for each in learned)], params, compute, scratch))
    return learned


def learn_next(
    clips: ClipSet, found: list[TrackNet], params: TrackerParams, compute: ComputeParams, scratch: Path
) -> Learned:
    """The next detector: the first one's weights, fine-tuned with all earlier objects masked out."""
    recipe, number = params.chosen(), len(found)
    ignored = masks(clips, found, params)
    task = lesson(clips, recipe, params.signals, ignored)
    left = motion_left(task.held_out, found[0].detector.stride)
    if left < params.least_motion:
        reason = f"asks for more than {number} objects; beside the first {number} only {left:.0%} of the motion is left"
        raise InputError("params.yaml: `objects` of this data set", reason, "lower it to the number that move")
    net = _copy(found[0])
    net.restart()
    curve = task.run(net, recipe.rest, 1000 * compute.seed + number, scratch / f"object{number}.pt", f"object {number}")
    return Learned(net, curve, task.read(net), [])


def motion_left(batches: list[Moments], stride: int) -> float:
    """Mean share of a frame's motion residual that lies outside what is ignored."""
    shares = [batch.outside_mask(batch.motion(stride)).flatten(1).sum(1).mean().item() for batch in batches]
    return float(np.mean(shares))


def masks(clips: ClipSet, found: list[TrackNet], params: TrackerParams) -> dict[str, NDArray[np.bool_]]:
    """(T, h, w) heat-map cells hidden by the objects found so far, for every clip that is learned from."""
    tracker, mask = together(found, params.tracking), params.tracking.mask
    assert isinstance(tracker, SequentialTracker)  # nothing is masked for a detector with several peaks
    hidden = {}
    for name in clips.names("train", "valid"):
        frames = clips.frames(name)
        ignored = hidden_by(tracker.track_all(frames), mask, *frames.shape[1:3])
        assert ignored is not None  # there is at least one earlier object
        hidden[name] = cells(ignored, found[0].detector.stride)
    return hidden


def _copy(net: TrackNet) -> TrackNet:
    twin = TrackNet(net.params, net.judge.frame_size)
    twin.load_state_dict(net.state_dict())
    return twin
