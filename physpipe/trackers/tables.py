"""THE track table of a data set, by the learned tracker: before and after refinement."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from statistics import multimode
from typing import NamedTuple, TypeVar

import numpy as np
import pandas as pd
import torch
from numpy.typing import NDArray

from physpipe.core.objects import ObjectsParams
from physpipe.core.parallel import in_parallel, worker_count
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.trackers.base import Trajectory
from physpipe.trackers.joint import PeakTracker
from physpipe.trackers.look import RefineParams
from physpipe.trackers.refinement import refined
from physpipe.trackers.sequential import SequentialTracker

Result = TypeVar("Result")


class Found(NamedTuple):
    """K objects of one clip."""

    xy: NDArray[np.float32]
    """(T, K, 2) pixels."""
    score: NDArray[np.float32]
    """(T, K) in [0, 1]."""
    status: NDArray[np.str_]
    """(T, K) `tracked` or `ambiguous`."""


def track_tables(
    clips: ClipSet, tracker: SequentialTracker | PeakTracker, objects: ObjectsParams, refine: RefineParams | None
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The table of every clip, and the same as it was before refinement.

    Object k is the same through a clip, and as far as colours tell it looks the same in all clips.
    """
    every = _of_every_clip(clips, lambda name: tracker.track_all(clips.frames(name)), "tracking clips")
    count = objects.objects or multimode(max(1, sum(not each.still for each in found)) for found in every.values())[0]
    before = {name: _first(each, count, len(clips.times_s(name))) for name, each in every.items()}
    if isinstance(tracker, PeakTracker) and count > 1:
        before = _by_colour(clips, before)
    after = before
    if refine is not None:
        after = _of_every_clip(
            clips, lambda name: _refined(clips.frames(name), before[name], refine), "refining tracks"
        )
    return _table(clips, after), _table(clips, before)


def _of_every_clip(clips: ClipSet, work: Callable[[str], Result], what: str) -> dict[str, Result]:
    """Clip to `work(clip)`, a thread a clip: Torch and OpenCV run side by side in threads, which share one net, and
    each thread has its clip to itself, so that no number depends on how many there are.
    """
    names = clips.names()
    with ThreadPoolExecutor(worker_count(), initializer=torch.set_num_threads, initargs=(1,)) as pool:
        return dict(zip(names, in_parallel(work, names, what, pool), strict=True))


def _table(clips: ClipSet, found: dict[str, Found]) -> pd.DataFrame:
    parts = [tracks.rows(name, clips.times_s(name), each.xy, each.score, each.status) for name, each in found.items()]
    return pd.concat(parts, ignore_index=True)


def _first(found: Sequence[Trajectory], count: int, length: int) -> Found:
    """The surest `count` tracks; lost throughout where there are fewer."""
    xy = np.full((length, count, 2), np.nan, np.float32)
    score, doubtful = np.zeros((length, count), np.float32), np.zeros((length, count), bool)
    for k, each in enumerate(found[:count]):
        xy[:, k], score[:, k] = each.xy, each.score
        if each.ambiguous is not None:
            doubtful[:, k] = each.ambiguous
    return Found(xy, score, np.where(doubtful, tracks.AMBIGUOUS, "tracked"))


def _refined(frames: NDArray[np.uint8], found: Found, params: RefineParams) -> Found:
    held = np.array(frames)  # mapped from disk: read once for all objects
    return found._replace(xy=np.stack([refined(held, each, params) for each in found.xy.swapaxes(0, 1)], axis=1))


def _by_colour(clips: ClipSet, found: dict[str, Found]) -> dict[str, Found]:
    """Each clip's objects in the order of their colour along the axis on which objects of a clip differ most."""
    colours = {name: _colours(clips.frames(name), each.xy) for name, each in found.items()}
    differences = np.concatenate([each - np.nanmean(each, axis=0) for each in colours.values()])
    axis = np.linalg.svd(np.nan_to_num(differences), full_matrices=False)[2][0]
    axis *= np.sign(axis[np.abs(axis).argmax()])
    ordered = {}
    for name, each in found.items():
        order = np.argsort(colours[name] @ axis, kind="stable")
        ordered[name] = Found(each.xy[:, order], each.score[:, order], each.status[:, order])
    return ordered


def _colours(frames: NDArray[np.uint8], xy: NDArray[np.float32]) -> NDArray[np.float64]:
    """(K, 3) median colour at the places of each object; the clip's mean colour for one that is never seen."""
    colours = np.tile(frames.mean(axis=(0, 1, 2)), (xy.shape[1], 1))
    for k in range(xy.shape[1]):
        seen = np.flatnonzero(np.isfinite(xy[:, k]).all(axis=1))
        if len(seen):
            columns, rows = np.rint(xy[seen, k]).astype(int).T
            limits = (frames.shape[1] - 1, frames.shape[2] - 1)
            colours[k] = np.median(frames[seen, rows.clip(0, limits[0]), columns.clip(0, limits[1])], axis=0)
    return colours
