"""Learns one detector more per object by sequential masking (paper section 3.1)."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physpipe.core.determinism import ComputeParams
from physpipe.core.errors import InputError
from physpipe.core.objects import ObjectsParams
from physpipe.io.clips import ClipSet
from physpipe.tracker_learning.lesson import Learned, copied, lesson
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.trackers.detectors import together
from physpipe.trackers.learned import cells
from physpipe.trackers.sequential import SequentialTracker, hidden_by
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.moments import Moments


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
    task = lesson(clips, params, ignored)
    left = motion_left(task.held_out, found[0].detector.stride)
    if left < params.least_motion:
        reason = f"asks for more than {number} objects; beside the first {number} only {left:.0%} of the motion is left"
        raise InputError("params.yaml: `objects` of this data set", reason, "lower it to the number that move")
    net = copied(found[0])
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
