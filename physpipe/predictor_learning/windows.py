"""Stretches of clips to learn motion from: the first frames and positions seen, the later positions asked for."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import torch
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.determinism import device
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.core.progress import progress
from physpipe.io import tracks
from physpipe.io.clips import TABLE, ClipSet, Split, common_size
from physpipe.predictor_learning.arrays import as_input, padded, whole
from physpipe.predictor_learning.mirrors import Symmetry, mirrored
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.steadying import camera_path

KEYS = "`predict.horizon` (`predict.interpolation` for what is trained to it)"
"""What says how far a training reaches."""


class WindowParams(Section):
    """What is drawn from the clips."""

    noise_px: float = Field(ge=0)
    """Standard deviation, a coordinate, of noise added to the seen positions in training; pixels."""
    first_share: float = Field(ge=0, le=1)
    """Share of the windows drawn in training that begin at a clip's first frame, as the forecasts do."""
    valid_windows: int = Field(ge=1)
    """Windows of the validation clips: evenly spread ones that a validation looks at, and the soonest to begin, to
    which is fitted how sure forecasts are."""


class TrackWindows:
    """Every stretch of `horizon` + 1 frames of one split whose positions are all known.

    With `sees_end` the last frame of a stretch is seen too. With `steady` the camera's motion is taken off, so that all
    positions are as in the last frame that is seen with those before. With `mirrors` what is drawn is mirrored at
    random, and turned where frames are square. Raises InputError when no clip is so long, when the predictor sees so
    many frames that none is left to forecast, when clips differ in size or number of objects, or when the tracks lack a
    clip.
    """

    def __init__(
        self,
        clips: ClipSet,
        table: pd.DataFrame,
        split: Split,
        seen_frames: int,
        horizon: int,
        sees_end: bool = False,
        steady: bool = False,
        mirrors: bool = True,
    ):
        self.seen_frames, self.horizon, self.mirrors = seen_frames, horizon, mirrors
        self.seen = [*range(seen_frames), horizon] if sees_end else list(range(seen_frames))
        """Numbers of the seen frames within a stretch."""
        if horizon < seen_frames:
            reason = f"frame {horizon} is one of the {seen_frames} that the predictor sees"
            raise InputError("params.yaml", reason, f"raise {KEYS}")
        self.height, self.width = common_size(clips)
        self.objects = tracks.object_count(clips.folder, table)
        """K, the same in every clip."""
        names = clips.names(split)
        known = tracks.by_clip(table)
        lacking = [name for name in names if name not in known]
        if lacking:
            raise InputError(clips.folder / TABLE, f"no tracks of clip {lacking[0]}", "make the tracks again")
        self.frames = [clips.frames(name) for name in names]
        self.xy = [known[name] for name in names]
        self.camera = self._camera_paths() if steady else None
        """Of each clip, (T, 2) px by which the still scene has shifted since the first frame; None: not taken off."""
        begins = [whole(xy, horizon + 1) for xy in self.xy]
        self.index = np.array([(i, at) for i, ok in enumerate(begins) for at in np.flatnonzero(ok)], np.int64)
        self.skipped = sum(int((~ok).sum()) for ok in begins)
        """Windows left out because an object is lost in them."""
        if not len(self.index):
            reason = f"no {split} clip has {horizon + 1} consecutive frames with all objects tracked"
            raise InputError(clips.folder / TABLE, reason, f"lower {KEYS} or give longer clips")
        self.frames_per_s = float(1 / np.median([np.diff(clips.times_s(name)).mean() for name in names]))
        """That of most clips."""

    def __len__(self) -> int:
        return len(self.index)

    def evenly(self, count: int) -> NDArray[np.int64]:
        """At most `count` window numbers, spread over all clips."""
        return np.unique(np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(np.int64))

    def early(self, count: int) -> NDArray[np.int64]:
        """The `count` window numbers, or fewer, that begin soonest in their clips."""
        return np.argsort(self.index[:, 1], kind="stable")[:count]

    def batch(self, numbers: Sequence[int], symmetries: Sequence[Symmetry] | None = None) -> Window:
        """The windows of those numbers, each turned and mirrored by its symmetry, on the device."""
        T0, asked = self.seen_frames, self.horizon + 1 - self.seen_frames
        cut = [self._cut(number) for number in numbers]
        if symmetries is not None:
            cut = [mirrored(*window, how) for window, how in zip(cut, symmetries, strict=True)]
        track = padded([positions for _, positions in cut]).to(device())
        within = torch.from_numpy(self.index[list(numbers), 1, None] + np.arange(self.horizon + 1)).to(device())
        xy = track[torch.arange(len(cut), device=device())[:, None], within]
        times = torch.arange(self.horizon + 1, dtype=torch.float32, device=device()).expand(len(cut), -1)
        frames = as_input(np.stack([frames for frames, _ in cut]))
        seen = Seen(frames, xy[:, :T0], times[:, self.seen], steady=self.camera is not None)
        return Window(seen, times[:, -asked:], xy[:, T0:], self.frames_per_s, track)

    def draw(self, count: int, params: WindowParams, generator: torch.Generator) -> Window:
        """`count` random windows, mirrored or not, with noise on the seen positions."""
        numbers = self.pick(count, params.first_share, generator)
        flips = torch.randint(2, (count, 3), generator=generator).bool()
        flips[:, 2] &= self.height == self.width
        drawn = self.batch(numbers, [tuple(each) for each in flips.tolist()] if self.mirrors else None)
        noise = torch.randn(drawn.seen.xy.shape, generator=generator).to(device()) * params.noise_px
        return replace(drawn, seen=replace(drawn.seen, xy=drawn.seen.xy + noise))

    def pick(self, count: int, first_share: float, generator: torch.Generator) -> list[int]:
        """Random window numbers, a share of them from the clips' beginnings where those can be used."""
        numbers = torch.randint(len(self), (count,), generator=generator)
        begin = torch.from_numpy(np.flatnonzero(self.index[:, 1] == 0))
        if len(begin):
            firsts = round(first_share * count)
            numbers[:firsts] = begin[torch.randint(len(begin), (firsts,), generator=generator)]
        return numbers.tolist()

    def film(self, number: int, frames: Sequence[int]) -> NDArray[np.uint8]:
        """(F, H, W, 3) RGB of those frames of a window, 0 being its first."""
        clip, at = self.index[number]
        return self.frames[clip][[at + each for each in frames]]

    def _cut(self, number: int) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """The seen frames, and where the objects are in all of the clip."""
        clip, at = self.index[number]
        frames = self.film(number, self.seen)
        if self.camera is None:
            return frames, self.xy[clip]
        shift = self.camera[clip] - self.camera[clip][at + self.seen_frames - 1]
        return frames, self.xy[clip] - shift[:, None]

    def _camera_paths(self) -> list[NDArray[np.float32]]:
        return [camera_path(as_input(np.stack([each]))[0]).cpu().numpy() for each in progress(self.frames, "camera")]
