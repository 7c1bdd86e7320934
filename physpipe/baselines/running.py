"""The baselines over the clips of the test split."""

from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.baselines.zoo import BASELINES, Finder, Follower, Settings
from physpipe.core.errors import InputError
from physpipe.core.parallel import in_parallel
from physpipe.flownet.classical import Remembered
from physpipe.io import tracks
from physpipe.io.annotations import Annotations, Box
from physpipe.io.clips import ClipSet
from physpipe.trackers.base import Trajectory


class Job(NamedTuple):
    """One clip's work."""

    clip: str
    truth: NDArray[np.floating]
    """(T, K, 2) pixels; K = 1 and all NaN when nobody annotated the clip."""
    boxes: list[list[Box]]
    """The user's boxes around each of the K objects."""


def baseline_tracks(
    clips: ClipSet, given: Annotations, truth: pd.DataFrame, settings: Settings
) -> dict[str, pd.DataFrame]:
    """Tracker name to its track table of the test split.

    A follower has rows of annotated clips only, and without any truth no table at all. Raises InputError naming the
    clip that a tracker refuses.
    """
    known = tracks.by_clip(truth)
    jobs = []
    for clip in clips.names("test"):
        xy = known.get(clip, np.full((len(clips.times_s(clip)), 1, 2), np.nan, np.float32))
        jobs.append(Job(clip, xy, [given.boxes(clip, k) for k in range(xy.shape[1])]))
    # Clip by clip, all trackers of a clip together: those that follow the same flow share its fields.
    found = list(in_parallel(partial(_track_clip, clips, settings, frozenset(known)), jobs, "baselines"))
    by_name = {name: [tables[name] for tables in found if name in tables] for name in settings.params.names}
    return {name: pd.concat(tables, ignore_index=True) for name, tables in by_name.items() if tables}


def _track_clip(clips: ClipSet, settings: Settings, annotated: frozenset[str], job: Job) -> dict[str, pd.DataFrame]:
    frames, times_s = clips.frames(job.clip), clips.times_s(job.clip)
    settings = settings._replace(flows={name: Remembered(flow) for name, flow in settings.flows.items()})
    tables = {}
    for name in settings.params.names:
        if job.clip not in annotated and isinstance(BASELINES[name], Follower):
            continue
        try:
            found = _tracked(BASELINES[name], settings, frames, job)
        except InputError as error:
            raise InputError(f"clip `{job.clip}`, {error.where}", error.reason, error.mend) from None
        xy, score = (np.stack(part, axis=1) for part in zip(*((each.xy, each.score) for each in found), strict=True))
        tables[name] = tracks.rows(job.clip, times_s, xy, score)
    return tables


def _tracked(baseline: Finder | Follower, settings: Settings, frames: NDArray[np.uint8], job: Job) -> list[Trajectory]:
    """A trajectory for each of the K objects."""
    if isinstance(baseline, Finder):
        return baseline.build(settings).track_all(frames, job.truth.shape[1])
    objects = zip(job.truth.swapaxes(0, 1), job.boxes, strict=True)
    return [_follow(baseline, settings, frames, truth, boxes) for truth, boxes in objects]


def _follow(
    baseline: Follower,
    settings: Settings,
    frames: NDArray[np.uint8],
    truth: NDArray[np.floating],
    boxes: list[Box],
) -> Trajectory:
    """From where the object, at `truth` (T, 2), first shows; one that never shows leaves nothing to start from."""
    xy, score = np.full((len(frames), 2), np.nan, np.float32), np.zeros(len(frames), np.float32)
    visible = np.flatnonzero(np.isfinite(truth).all(axis=1))
    if len(visible):
        first, start = int(visible[0]), truth[visible[0]]
        around = _boxes(boxes, first, start, 2 * settings.params.box_radii * settings.radius_px)
        found = baseline.build(settings, around).track(frames[first:], start)
        xy[first:], score[first:] = found.xy, found.score
    return Trajectory(xy, score)


def _boxes(drawn: list[Box], first: int, start: NDArray[np.floating], box_px: float) -> list[Box]:
    """The user's boxes, their frames counted from `first`, or for want of any a square one around the start."""
    kept = [box._replace(frame=box.frame - first) for box in drawn if box.frame >= first]
    side = 2 * round((box_px - 1) / 2) + 1
    x, y = (float(middle) - (side - 1) / 2 for middle in start)
    return kept or [Box(0, x, y, side, side)]
