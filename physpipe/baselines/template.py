"""LAB template tracker: zero-normalised cross-correlation, smoothed by a global optimum over the clip.

How the paper made its ground truth (end of section 4), before manual correction. Its smoothness term is not described;
here it is a cost on displacement, and the track is the Viterbi path through the best peaks of every frame and "lost".
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.baselines.correlation import peaks, zncc
from physpipe.core.colour import srgb_to_lab
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.io.annotations import Box
from physpipe.trackers.base import Trajectory


class TemplateParams(Section):
    """How alike a patch must look and how far an object may move."""

    candidates: int = Field(ge=1)
    """Correlation peaks kept per frame and template; the path is chosen among them."""
    flat_lab: float = Field(gt=0)
    """Patches whose LAB values vary by less than this (standard deviation) correlate with nothing."""
    smoothness_per_px2: float = Field(ge=0)
    """Score taken off for a displacement of 1 px between frames; grows with its square."""
    lost_score: float = Field(ge=-1, le=1)
    """Score of a frame in which the object is lost: correlation below this speaks for "lost"."""
    lost_switch: float = Field(ge=0)
    """Score taken off for getting lost and again for being found anew, anywhere."""


class Template(NamedTuple):
    """A patch that looks like the object."""

    patch: NDArray[np.float32]
    """(h, w, 3) LAB."""
    offset: NDArray[np.float64]
    """(2,) px from the patch's middle pixel ((w - 1) // 2, (h - 1) // 2) to the object's centre."""


class Candidates(NamedTuple):
    """Where the object may be in each frame, N places a frame."""

    xy: NDArray[np.float64]
    """(T, N, 2) pixels."""
    score: NDArray[np.float64]
    """(T, N) correlation, -inf where a frame has fewer than N peaks."""
    lost: NDArray[np.float64]
    """(T,) score of being lost instead."""


class TemplateTracker:
    """Follows what the given boxes show; without any box it is lost in every frame."""

    def __init__(self, params: TemplateParams, boxes: Sequence[Box]):
        self.params, self.boxes = params, boxes

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """The path of highest correlation less displacement, through the boxes' centres; they stand for `start`."""
        found = candidates(frames, self.boxes, self.params, ignore)
        path = best_path(found, self.params)
        seen = np.flatnonzero(path >= 0)
        xy, score = np.full((len(frames), 2), np.nan, np.float32), np.zeros(len(frames), np.float32)
        xy[seen], score[seen] = found.xy[seen, path[seen]], found.score[seen, path[seen]].clip(0, 1)
        return Trajectory(xy, score)


def cut(frame: NDArray[np.uint8], box: Box) -> Template:
    """The part of `frame` (H, W, 3) inside the box, as a template of the box's centre.

    Raises InputError when the box is larger than the frame.
    """
    H, W = frame.shape[:2]
    if box.w > W or box.h > H:
        reason = f"a template of {box.w:g} x {box.h:g} pixels is larger than the frame of {W} x {H}"
        raise InputError("tracker `lab`", reason, "draw a smaller box, or lower `baselines.box_radii`")
    left, top = max(round(box.x), 0), max(round(box.y), 0)
    patch = srgb_to_lab(frame[top : max(round(box.y + box.h), 1), left : max(round(box.x + box.w), 1)])
    h, w = patch.shape[:2]
    return Template(patch, np.array(box.centre) - [left + (w - 1) // 2, top + (h - 1) // 2])


def candidates(
    frames: NDArray[np.uint8], boxes: Sequence[Box], params: TemplateParams, ignore: NDArray[np.bool_] | None
) -> Candidates:
    """The best peaks of every template in every frame; a frame that holds a box has that box's centre alone."""
    templates = [cut(frames[box.frame], box) for box in boxes]
    N = params.candidates * len(templates)
    xy, score = np.zeros((len(frames), N, 2)), np.full((len(frames), N), -np.inf)
    for t, frame in enumerate(frames):
        lab = srgb_to_lab(frame)
        for n, template in enumerate(templates):
            response = zncc(lab, template.patch, params.flat_lab)
            where, height = peaks(response, params.candidates, None if ignore is None else ignore[t])
            mine = slice(n * params.candidates, n * params.candidates + len(height))
            xy[t, mine], score[t, mine] = where + template.offset, height
    lost = np.full(len(frames), params.lost_score)
    for box in boxes:  # the user's word stands
        score[box.frame] = lost[box.frame] = -np.inf
        xy[box.frame, 0], score[box.frame, 0] = box.centre, 1
    return Candidates(xy, score, lost)


def best_path(found: Candidates, params: TemplateParams) -> NDArray[np.int64]:
    """(T,) index of the candidate in each frame, -1 for lost: the path of the highest total score (Viterbi)."""
    T, N = found.score.shape
    score = np.concatenate([found.score, found.lost[:, None]], axis=1)
    total, came_from = score[0], np.zeros((T, N + 1), np.int64)
    move = np.full((N + 1, N + 1), -params.lost_switch)
    move[N, N] = 0
    for t in range(1, T):
        squared_px = ((found.xy[t - 1, :, None] - found.xy[t, None]) ** 2).sum(axis=2)
        move[:N, :N] = -params.smoothness_per_px2 * squared_px
        options = total[:, None] + move  # from row to column
        came_from[t] = options.argmax(axis=0)
        total = options.max(axis=0) + score[t]
    path = np.empty(T, np.int64)
    path[-1] = total.argmax()
    for t in range(T - 1, 0, -1):
        path[t - 1] = came_from[t, path[t]]
    return np.where(path == N, -1, path)
