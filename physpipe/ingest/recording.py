"""One recording to small upright pictures and a table that says which picture each clip's frame shows."""

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field, model_validator

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.core.params import Section
from physpipe.ingest import framing, rates, resampling
from physpipe.ingest.framing import CropParams
from physpipe.ingest.motion import TrimParams, moving_span
from physpipe.io import packed, video

SHORTEST = 5  # frames; the trackers need as many to see motion


class ConvertParams(Section):
    """All that decides the frames of a recording's clips."""

    fps: float | None = Field(gt=0)
    """Frames per second of the clips, by nearest timestamp; null keeps every source frame."""
    source_fps: float | None = Field(gt=0)
    """True frames per second of the recordings where their timestamps lie (slow motion); null trusts them."""
    crop: CropParams | None
    """Box to keep; null keeps the largest centred square."""
    size: int = Field(ge=16, multiple_of=8)
    """Side of the clips' square frames, in pixels."""
    trim: TrimParams | None
    """How motion is found; null keeps the still beginning and end too."""
    max_gap_s: float = Field(gt=0)
    """A longer hole in a recording, in seconds, ends the clip; a shorter one is filled with `missing` frames."""
    clip_frames: int = Field(ge=SHORTEST)
    """Frames of a clip; longer recordings are cut into several."""
    min_frames: int = Field(ge=SHORTEST)
    """A shorter remainder is dropped, and counted."""

    @model_validator(mode="after")
    def _remainders_can_be_kept(self) -> "ConvertParams":
        if self.min_frames > self.clip_frames:
            raise ValueError("min_frames exceeds clip_frames")
        return self


def convert(path: Path, folder: Path, params: ConvertParams) -> None:
    """Writes the pictures, rows, geometry and summary of the recording `path` into a new entry `folder`.

    The rows are `resampling.rows`'s, with `part`, the number of the clip that a row belongs to.
    Raises InputError when the recording cannot be read or gives no clip.
    """
    recording = video.Recording(path, params.source_fps)
    with packed.writing(folder) as entry:
        geometry, times_s, decoded, counts = _write_pictures(recording, entry, params)
        pictures = entry.pictures(params.size, params.size)
        rows = resampling.rows(times_s, decoded, counts, params.fps, params.max_gap_s)
        moving = _moving(path, rows, pictures, params.trim)
        cut = _cut(moving, params.clip_frames, params.min_frames)
        if cut.empty:
            reason = f"moves in {len(moving)} frames only; a clip has at least {params.min_frames}"
            raise InputError(path, reason, f"film longer, or lower `min_frames` (at least {SHORTEST})")
        summary = rates.summary(recording, times_s, decoded, params.fps)
        summary |= {"kept": len(cut), "dropped": len(moving) - len(cut)}
        entry.finish(cut, geometry, summary)


def _write_pictures(
    recording: video.Recording, entry: packed.Writer, params: ConvertParams
) -> tuple[Geometry, NDArray[np.float64], NDArray[np.bool_], NDArray[np.int64]]:
    """Geometry, and time, decoded or not, and number of target times of every source frame."""
    times_s, decoded, counts = [], [], []
    geometry = shape = None
    for frame, count in resampling.nearest(recording, params.fps):
        times_s.append(frame.time_s)
        decoded.append(frame.image is not None)
        counts.append(count)
        if count and frame.image is not None:
            pixels = video.rgb(frame.image)
            shape = shape or pixels.shape
            if geometry is None:
                geometry = framing.geometry(recording.path, shape, params.crop, params.size)
            elif pixels.shape != shape:
                reason = f"frame {frame.number} is {pixels.shape[:2]} px (height, width), the first one {shape[:2]}"
                raise InputError(recording.path, reason, "split the recording where its size changes")
            entry.add(framing.reframed(pixels, geometry))
    if geometry is None:
        raise InputError(recording.path, "holds no frame that can be decoded", "remove it or convert it anew")
    return geometry, np.array(times_s), np.array(decoded, bool), np.array(counts, np.int64)


def _moving(path: Path, rows: pd.DataFrame, pictures: NDArray[np.uint8], trim: TrimParams | None) -> pd.DataFrame:
    """The rows from the first to the last that moves."""
    span = (0, len(pictures) - 1) if trim is None else moving_span(pictures, trim)
    if span is None or all(np.array_equal(picture, pictures[0]) for picture in pictures[1:]):
        raise InputError(path, "nothing moves", "remove it, or check `crop` and `trim` of this data set")
    return rows[rows["picture"].between(*span)]


def _cut(rows: pd.DataFrame, clip_frames: int, min_frames: int) -> pd.DataFrame:
    """Rows with the number of their clip; a clip spans no hole and has `min_frames` to `clip_frames` rows."""
    piece = rows.groupby("segment").cumcount() // clip_frames
    numbered = rows.assign(part=rows.assign(piece=piece).groupby(["segment", "piece"]).ngroup())
    kept = numbered[numbered.groupby("part")["part"].transform("size") >= min_frames]
    return kept.assign(part=kept.groupby("part").ngroup())
