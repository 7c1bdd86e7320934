"""Tracks in the pixels and frame numbers that another program counts in."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io.clips import ClipSet

Pixels = Literal["clip", "source"]
METRES = ["x_m", "y_m"]
SAME_RATE = 1e-6
"""Relative difference of frame rates that are one."""


@dataclass(frozen=True)
class Located:
    """A set's tracks, ready to be written."""

    name: str
    pixels: Pixels
    """`clip`: of the clips' frames; `source`: of the upright recording."""
    table: pd.DataFrame
    """A row a clip, object and frame: columns of the track table, x and y in `pixels`; source, source_frame,
    source_time_s, frame_status; x_m and y_m where the scale is known, from the recording's top-left pixel."""
    clips: ClipSet
    radius_px: float
    """Of an object, in clip pixels."""
    pixels_per_metre: float | None
    """In the recording."""

    @property
    def counted(self) -> pd.DataFrame:
        """Rows with a position, `frame` being the number that goes with the pixels.

        In source pixels that is the recording's own, in decode order; what a clip shows twice counts once.
        """
        seen = self.table[self.table["visible"]]
        if self.pixels == "clip":
            return seen
        shown = seen[seen["frame_status"] == "ok"]
        return shown.assign(frame=shown["source_frame"]).drop_duplicates(["clip", "object", "frame"])

    def fps(self, clip: str) -> float:
        """Frames per second of a clip, in the numbers of `counted`; NaN for a single frame."""
        if self.pixels == "clip":
            return self.clip_fps(clip)
        rows = self.clips.rows(clip)
        return _rate(rows["source_frame"], rows["source_time_s"])

    def clip_fps(self, clip: str) -> float:
        """Frames per second in the clip's own numbers; NaN for a single frame."""
        rows = self.clips.rows(clip)
        return _rate(rows["frame"], rows["time_s"])

    def last_frame(self, clip: str) -> int:
        """The largest number that `counted` may give a frame of the clip."""
        return int(self.clips.rows(clip)["frame" if self.pixels == "clip" else "source_frame"].max())

    def pixels_per_clip_pixel(self, clip: str) -> tuple[float, float]:
        """Along x and y."""
        across, down = self.clips.geometry(clip).scale
        return (1.0, 1.0) if self.pixels == "clip" else (float(1 / across), float(1 / down))

    def about(self, kind: str, path: Path) -> dict[str, Any]:
        """What a reader must know beside the numbers; `path` is the table that they come from."""
        frames = "of the clip" if self.pixels == "clip" else "of the recording, in decode order"
        return {
            "set": self.name,
            "tracks": path.as_posix(),
            "format": kind,
            "pixels": self.pixels,
            "axes": "origin at the centre of the top-left pixel, x right, y down",
            "frames": f"{frames}, from 0",
            "frames_per_s": self._of_clips(self.fps),
            "clip_frames_per_s": self._of_clips(self.clip_fps),
            "pixels_per_metre": self.pixels_per_metre,
            "pixels_per_metre_of": "the recording",
        }

    def _of_clips(self, rate: Callable[[str], float]) -> float | dict[str, float]:
        """One figure where all clips agree, else clip to figure."""
        rates = {clip: rate(clip) for clip in self.table["clip"].unique()}
        first = next(iter(rates.values()))
        alike = np.allclose(list(rates.values()), first, rtol=SAME_RATE, equal_nan=True)
        return first if alike else rates


def located(
    name: str, path: Path, table: pd.DataFrame, clips: ClipSet, pixels: Pixels, radius_px: float, scale: float | None
) -> Located:
    """`table` (of the file `path`) in `pixels`; `scale` is the recording's pixels per metre.

    Raises InputError when there are no tracks, or some of a clip that the set does not have.
    """
    refuse_nothing_found(path, table)
    origin = clips.table[["clip", "frame", "source", "source_frame", "source_time_s", "status"]]
    joined = table.merge(origin.rename(columns={"status": "frame_status"}), on=["clip", "frame"], how="left")
    if joined["source"].isna().any():
        clip = joined.loc[joined["source"].isna(), "clip"].iloc[0]
        reason = f"tracks of clip {clip}, which the set has not so long"
        raise InputError(path, reason, "track the clips again, or give by --table what was tracked in these")
    groups = [_located(rows, clips.geometry(str(clip)), pixels, scale) for clip, rows in joined.groupby("clip")]
    return Located(name, pixels, pd.concat(groups, ignore_index=True), clips, radius_px, scale)


def refuse_nothing_found(path: Path, table: pd.DataFrame) -> None:
    """Raises InputError where no object of the track table of the file `path` has a position anywhere."""
    if not table["visible"].any():
        reason = "no tracks: the tracker found nothing, or, in a table of truth, nobody annotated the film"
        mend = "see report/index.html for what the tracker saw, annotate, or give other tracks by --table"
        raise InputError(path, reason, mend)


def _located(rows: pd.DataFrame, geometry: Geometry, pixels: Pixels, scale: float | None) -> pd.DataFrame:
    in_source = geometry.to_source(rows[["x", "y"]])
    moved = rows.copy()
    if pixels == "source":
        moved[["x", "y"]] = in_source
    if scale is not None:
        moved[METRES] = in_source / scale
    return moved


def _rate(frames: pd.Series, times_s: pd.Series) -> float:
    steps, seconds = np.diff(frames), np.diff(times_s)
    grows = seconds > 0
    return float(np.median(steps[grows] / seconds[grows])) if grows.any() else float("nan")
