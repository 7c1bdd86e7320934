"""The annotated test clips that trackers are scored on, and every frame's error there."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.progress import progress
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.metrics import trackers as metrics
from physpipe.metrics.trackers import OtherMotionParams


class Case(NamedTuple):
    """One annotated test clip."""

    clip: str
    truth: NDArray[np.floating]
    """(T, K, 2) pixels."""
    disturbed: NDArray[np.bool_]
    """(T,) frames counted apart, since something else moves in them."""
    width: int
    height: int


def annotated_cases(clips: ClipSet, truth: pd.DataFrame, other: OtherMotionParams, radius_px: float) -> list[Case]:
    """The annotated test clips; frames count as disturbed by the user's tags or, if there are none, by what moves."""
    tags = truth.loc[truth["tag"] != ""] if "tag" in truth else truth.iloc[:0]
    cases = []
    tested = {clip: xy for clip, xy in tracks.by_clip(truth).items() if clips.split(clip) == "test"}
    for clip, xy in progress(tested.items(), "what else moves"):
        frames = clips.frames(clip)
        if len(tags):
            disturbed = np.isin(np.arange(len(xy)), tags.loc[tags["clip"] == clip, "frame"])
        else:
            disturbed = metrics.other_motion(frames, xy, radius_px, other)
        cases.append(Case(clip, xy, disturbed, frames.shape[2], frames.shape[1]))
    return cases


def matched(found: NDArray[np.floating] | None, case: Case) -> NDArray[np.floating]:
    """(T, K, 2) tracks in the truth's order of objects; a clip without tracks is lost throughout."""
    return np.full(case.truth.shape, np.nan) if found is None else metrics.match(found, case.truth)


def errors_of(found: list[NDArray[np.floating]], cases: list[Case]) -> pd.DataFrame:
    """One row for each visible object: clip, object, frame, x and y offset, error_px, disturbed."""
    parts = []
    for xy, case in zip(found, cases, strict=True):
        frame, obj = np.nonzero(np.isfinite(case.truth).all(axis=2))
        offset = (xy - case.truth)[frame, obj].astype(np.float64)
        columns = {"object": obj, "frame": frame, "x": offset[:, 0], "y": offset[:, 1]}
        parts.append(pd.DataFrame({"clip": case.clip, **columns, "disturbed": case.disturbed[frame]}))
    if not parts:
        return pd.DataFrame(columns=["clip", "object", "frame", "x", "y", "disturbed", "error_px"], dtype=float)
    table = pd.concat(parts).sort_values(tracks.KEY, ignore_index=True)
    return table.assign(error_px=np.hypot(table["x"], table["y"]))
