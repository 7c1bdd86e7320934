"""The trackers that ours is compared with, run over the clips of the test split."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field, field_validator

from physpipe.baselines.constant import Centre, Persistence
from physpipe.baselines.template import TemplateParams, TemplateTracker
from physpipe.core.parallel import in_parallel
from physpipe.core.params import Section
from physpipe.io import tracks
from physpipe.io.annotations import Annotations, Box
from physpipe.io.clips import ClipSet
from physpipe.trackers.base import Tracker


class Settings(NamedTuple):
    """What the baselines may be told beside the frames and a start."""

    template: TemplateParams
    box_px: float
    """Side of the box around an object's start where the user drew none."""


class Baseline(NamedTuple):
    """A tracker to compare with, and what it has to be given."""

    build: Callable[[Settings, list[Box]], Tracker]
    """From the settings and the boxes around the object."""
    needs_start: bool
    """Whether it must be told where the object is when it first shows, as in the paper."""


BASELINES = {
    "lab": Baseline(lambda settings, boxes: TemplateTracker(settings.template, boxes), needs_start=True),
    "persistence": Baseline(lambda settings, boxes: Persistence(), needs_start=True),
    "centre": Baseline(lambda settings, boxes: Centre(), needs_start=False),
}


class BaselineParams(Section):
    """Which baselines run, and what stands in for a user's template box."""

    names: list[str]
    """Members of BASELINES."""
    box_radii: float = Field(gt=0)
    """Half the side of the box around an object's start, in its radii, where the user drew none."""

    @field_validator("names")
    @classmethod
    def _known(cls, names: list[str]) -> list[str]:
        unknown = sorted(set(names) - set(BASELINES))
        if unknown:
            raise ValueError(f"unknown {unknown}; known are {sorted(BASELINES)}")
        return names


class Job(NamedTuple):
    """One clip's work."""

    clip: str
    truth: NDArray[np.floating]
    """(T, K, 2) pixels; K = 1 and all NaN when nobody annotated the clip."""
    boxes: list[list[Box]]
    """The user's boxes around each of the K objects."""


def baseline_tracks(
    clips: ClipSet,
    given: Annotations,
    truth: pd.DataFrame,
    params: BaselineParams,
    template: TemplateParams,
    radius_px: float,
) -> dict[str, pd.DataFrame]:
    """Tracker name to its track table of the test split; `radius_px` is the objects' radius.

    A tracker that needs a start has rows of annotated clips only, and without any truth no table at all.
    """
    settings = Settings(template, 2 * params.box_radii * radius_px)
    known = tracks.by_clip(truth)
    jobs = []
    for clip in clips.names("test"):
        xy = known.get(clip, np.full((len(clips.times_s(clip)), 1, 2), np.nan, np.float32))
        jobs.append(Job(clip, xy, [given.boxes(clip, k) for k in range(xy.shape[1])]))
    tables = {}
    for name in params.names:
        wanted = [job for job in jobs if job.clip in known or not BASELINES[name].needs_start]
        if wanted:
            work = partial(_track_clip, name, clips, settings)
            tables[name] = pd.concat(in_parallel(work, wanted, name), ignore_index=True)
    return tables


def _track_clip(name: str, clips: ClipSet, settings: Settings, job: Job) -> pd.DataFrame:
    frames = clips.frames(job.clip)
    T, K = job.truth.shape[:2]
    xy, score = np.full((T, K, 2), np.nan, np.float32), np.zeros((T, K), np.float32)
    for k in range(K):
        visible = np.flatnonzero(np.isfinite(job.truth[:, k]).all(axis=1))
        if not BASELINES[name].needs_start:
            first, start, boxes = 0, None, []
        elif len(visible):
            first, start = int(visible[0]), job.truth[visible[0], k]
            boxes = _boxes(job.boxes[k], first, start, settings.box_px)
        else:
            continue  # an object that never shows leaves nothing to start from
        found = BASELINES[name].build(settings, boxes).track(frames[first:], start)
        xy[first:, k], score[first:, k] = found.xy, found.score
    return tracks.rows(job.clip, clips.times_s(job.clip), xy, score)


def _boxes(drawn: list[Box], first: int, start: NDArray[np.floating], box_px: float) -> list[Box]:
    """The user's boxes, their frames counted from `first`, or for want of any a square one around the start."""
    kept = [box._replace(frame=box.frame - first) for box in drawn if box.frame >= first]
    side = 2 * round((box_px - 1) / 2) + 1
    x, y = (float(middle) - (side - 1) / 2 for middle in start)
    return kept or [Box(0, x, y, side, side)]
