"""Clips: one packed uint8 file a clip, and one table with a row for every frame."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import results
from physpipe.io.atomic import replacing_folder

Split = Literal["train", "valid", "test"]
SPLITS: tuple[Split, ...] = get_args(Split)
TABLE = "clips.parquet"
RECORDINGS = "recordings.csv"
GEOMETRY = ["left", "top", "crop_width", "crop_height", "width", "height"]
COLUMNS = ["clip", "frame", "time_s", "source", "source_frame", "source_time_s", "status", "split", *GEOMETRY]


@dataclass(frozen=True)
class Clip:
    """A short film of one scene: frames, when each was taken, and where each came from."""

    name: str
    split: Split
    source: str
    """Path of the recording (a file, or a folder of images) inside the folder of the set's film."""
    geometry: Geometry
    frames: NDArray[np.uint8]
    """(T, H, W, 3) RGB; a frame that could not be decoded repeats the one before it and says so in `status`."""
    times_s: NDArray[np.float64]
    """(T,) seconds since the clip's first frame."""
    source_frames: NDArray[np.int32]
    """(T,) number of the frame in decode order in its recording, from 0."""
    source_times_s: NDArray[np.float64]
    """(T,) seconds in the recording."""
    status: NDArray[np.str_]
    """(T,) `ok`, `decode_error` or `missing`."""


class ClipSet:
    """The clips of one data set, read as they are needed."""

    def __init__(self, folder: Path):
        """Raises InputError when `folder` holds no clip table."""
        self.folder = folder
        if not (folder / TABLE).is_file():
            raise InputError(folder / TABLE, "no such file", "run `dvc repro`, which makes it in `ingest`")
        self.table = pd.read_parquet(folder / TABLE)
        self._rows = dict(list(self.table.groupby("clip", sort=True)))

    def __reduce__(self) -> tuple[type["ClipSet"], tuple[Path]]:
        """Crosses process pools as its folder: a worker reads the table itself."""
        return ClipSet, (self.folder,)

    def names(self, *splits: Split) -> list[str]:
        """Sorted clip names, of the given splits only when any is given."""
        return [name for name in self._rows if not splits or self.split(name) in splits]

    def rows(self, name: str) -> pd.DataFrame:
        """The table's rows of one clip; raises InputError for an unknown clip."""
        if name not in self._rows:
            raise InputError(self.folder / TABLE, f"no clip `{name}`", "use a name from its `clip` column")
        return self._rows[name]

    def split(self, name: str) -> Split:
        """The split that a clip belongs to."""
        return self.rows(name)["split"].iloc[0]

    def frames(self, name: str) -> NDArray[np.uint8]:
        """(T, H, W, 3) RGB, mapped from disk: only what is touched is read."""
        return np.load(self.folder / f"{name}.npy", mmap_mode="r")

    def times_s(self, name: str) -> NDArray[np.float64]:
        """(T,) seconds since the clip's first frame."""
        return self.rows(name)["time_s"].to_numpy()

    def geometry(self, name: str) -> Geometry:
        """Where the clip's frame lies in its source."""
        row = self.rows(name).iloc[0]
        return Geometry(*(row[key] for key in GEOMETRY))


def save(folder: Path, clips: Iterable[Clip], recordings: pd.DataFrame | None = None) -> None:
    """Writes a data set's clips, one at a time, into a folder that appears only when complete.

    `recordings`, a row for each recording that the clips come from, goes beside them as CSV.
    """
    tables = []
    with replacing_folder(folder) as temporary:
        for clip in clips:
            np.save(temporary / f"{clip.name}.npy", clip.frames)
            tables.append(_rows(clip))
        if not tables:
            raise InputError(folder, "no clip to save", "check that the recordings show motion")
        table = pd.concat(tables).sort_values(["clip", "frame"], ignore_index=True)
        table.to_parquet(temporary / TABLE, index=False)
        if recordings is not None:
            results.save_csv(temporary / RECORDINGS, recordings)


def _rows(clip: Clip) -> pd.DataFrame:
    geometry = {key: getattr(clip.geometry, key) for key in GEOMETRY}
    columns = {
        "clip": clip.name,
        "frame": np.arange(len(clip.frames), dtype=np.int32),
        "time_s": clip.times_s,
        "source": clip.source,
        "source_frame": clip.source_frames,
        "source_time_s": clip.source_times_s,
        "status": clip.status.astype(object),
        "split": clip.split,
    }
    return pd.DataFrame({**columns, **geometry})[COLUMNS]


def common_size(clips: ClipSet) -> tuple[int, int]:
    """(height, width) of every clip in pixels; raises InputError when they differ."""
    sizes = clips.table[["height", "width"]].drop_duplicates().to_numpy().tolist()
    if len(sizes) != 1:
        raise InputError(clips.folder / TABLE, f"clips of several sizes {sizes}", "ingest them with one `size`")
    return sizes[0][0], sizes[0][1]
