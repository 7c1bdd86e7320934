"""Truth for evaluation: reference positions or else the template tracker, then the user's corrections on top."""

import sys
from collections.abc import Iterator
from functools import partial

import numpy as np
import pandas as pd

from physpipe.baselines.template import TemplateParams, TemplateTracker
from physpipe.core.parallel import in_parallel
from physpipe.io import tracks
from physpipe.io.annotations import Annotations, Box
from physpipe.io.clips import ClipSet


def ground_truth(clips: ClipSet, given: Annotations, params: TemplateParams) -> pd.DataFrame:
    """Track table of the annotated clips (every clip that the user named), with a column `tag` more.

    A frame's tag is the reference's, "" elsewhere. Film that nobody annotated gives a table with no rows and a
    warning.
    """
    referenced = sorted(set(given.reference["clip"]))
    others = [name for name in given.clips() if name not in set(referenced)]
    jobs = [(name, [given.boxes(name, k) for k in range(given.objects(name))]) for name in others]
    tables = [
        *_from_reference(clips, given, referenced),
        *in_parallel(partial(_from_templates, clips, params), jobs, "template tracker"),
    ]
    if not tables:
        print("warning: no annotation found; nothing will be measured against a truth", file=sys.stderr)
        return tracks.empty().assign(tag="")
    return _corrected(pd.concat(tables, ignore_index=True), given.corrections)


def _from_reference(clips: ClipSet, given: Annotations, names: list[str]) -> Iterator[pd.DataFrame]:
    by_clip = dict(list(given.reference.groupby("clip")))
    for name in names:
        mine, times_s = by_clip[name], clips.times_s(name)
        xy = np.full((len(times_s), given.objects(name), 2), np.nan)
        xy[mine["frame"], mine["object"]] = mine[["x", "y"]]
        table = tracks.rows(name, times_s, xy, np.ones(xy.shape[:2]), "reference")
        tags = mine.drop_duplicates("frame").set_index("frame")["tag"]
        yield table.assign(tag=table["frame"].map(tags).fillna(""))


def _from_templates(clips: ClipSet, params: TemplateParams, job: tuple[str, list[list[Box]]]) -> pd.DataFrame:
    """Rows of one clip from the boxes of each of its objects; an object with no box is lost until corrected."""
    name, boxes = job
    times_s, frames = clips.times_s(name), clips.frames(name)
    xy, score = np.full((len(times_s), len(boxes), 2), np.nan), np.zeros((len(times_s), len(boxes)))
    for k, mine in enumerate(boxes):
        trajectory = TemplateTracker(params, mine).track(frames)
        xy[:, k], score[:, k] = trajectory.xy, trajectory.score
    return tracks.rows(name, times_s, xy, score).assign(tag="")


def _corrected(table: pd.DataFrame, corrections: pd.DataFrame) -> pd.DataFrame:
    """`table` with exactly the rows that `corrections` names replaced."""
    table = table.set_index(tracks.KEY)
    ours = corrections.set_index(tracks.KEY).rename_axis(tracks.KEY)
    visible = ours["visible"].astype(bool)
    table.loc[ours.index, ["x", "y"]] = ours[["x", "y"]].where(visible, axis=0).to_numpy(np.float32)
    table.loc[ours.index, "score"] = visible.to_numpy(np.float32)
    table.loc[ours.index, "visible"] = visible.to_numpy()
    table.loc[ours.index, "status"] = "corrected"
    return table.reset_index()
