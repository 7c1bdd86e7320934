"""Pyramidal Lucas-Kanade (Bouguet 2001) on a grid of points in the object's disc: the paper's OFLK.

Points are set anew in every frame and checked forward and back, as in Kalal et al. 2010 ("median flow"): points kept
through a clip slip off a ball that turns.
"""

from functools import partial

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory, required


class LucasKanadeParams(Section):
    """Where points are set and which are believed."""

    disc_radii: float = Field(gt=0)
    """Radius of the disc of points, in the object's."""
    spacing_px: float = Field(gt=0)
    """Grid step of the points."""
    window_radii: float = Field(gt=0)
    """Side of the window around a point that is matched, in the object's radii: wider ones see mostly background."""
    levels: int = Field(ge=0)
    """Halvings of the frame above the full one."""
    back_px: float = Field(gt=0)
    """Distance from where it began that a point, followed there and back, may end at."""


class LucasKanade:
    """Moves an object by the median displacement of its points."""

    def __init__(self, params: LucasKanadeParams, radius_px: float):
        self.params, self.radius_px = params, radius_px

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """From `start` on; lost while no point can be followed, and looked for where it was last seen."""
        place = required(start, frames, "lucas_kanade").astype(np.float64)
        xy, score = np.full((len(frames), 2), np.nan, np.float32), np.zeros(len(frames), np.float32)
        xy[0], score[0] = place, 1
        grid = self._grid()
        for t in range(1, len(frames)):
            points = (place + grid).astype(np.float32)
            moved, good = self._followed(frames[t - 1], frames[t], points)
            if ignore is not None:
                good &= ~_at(ignore[t - 1], points)
            if good.any():
                place = place + np.median((moved - points)[good], axis=0)
                xy[t], score[t] = place, good.mean()
        return Trajectory(xy, score)

    def _grid(self) -> NDArray[np.float64]:
        """(N, 2) offsets from the object's centre."""
        radius_px = self.params.disc_radii * self.radius_px
        steps = int(radius_px / self.params.spacing_px)
        line = self.params.spacing_px * np.arange(-steps, steps + 1)
        square = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        return square[np.hypot(*square.T) <= radius_px]

    def _followed(
        self, frame: NDArray[np.uint8], following: NDArray[np.uint8], points: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """(N, 2) points in the frame that follows, and (N,) which of them to believe."""
        side = max(3, round(self.params.window_radii * self.radius_px))
        follow = partial(cv2.calcOpticalFlowPyrLK, winSize=(side, side), maxLevel=self.params.levels)
        moved, there, _ = follow(frame, following, points, None)
        back, again, _ = follow(following, frame, moved, None)
        near = np.linalg.norm(back - points, axis=1) <= self.params.back_px
        return np.asarray(moved, np.float32), (there[:, 0] == 1) & (again[:, 0] == 1) & near


def _at(marks: NDArray[np.bool_], points: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(N,) the mark of each point's pixel; the frame's edge is repeated outwards."""
    H, W = marks.shape
    columns, rows = points.round().astype(int).clip(0, [W - 1, H - 1]).T
    return marks[rows, columns]
