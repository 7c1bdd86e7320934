"""A set of two clips cut from one film: every second frame, a squeezed crop, two balls, one lost for a while."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from worlds import ball_film, encoded

from physpipe.core.geometry import Geometry
from physpipe.exporting.located import Located, Pixels, located
from physpipe.ingest.framing import reframed
from physpipe.io import clips, tracks
from physpipe.io.clips import Clip, ClipSet

GEOMETRY = Geometry(10, 6, 60, 48, 30, 32)
"""A clip's pixel is 2 pixels wide and 1.5 high."""
FILM_FPS, EVERY, FRAMES = 100.0, 2, 20
LOST = slice(8, 12)
"""Frames of each clip in which object 1 is lost."""


@dataclass(frozen=True)
class Set:
    """The set and what is true of it."""

    raw: Path
    clips: ClipSet
    path: Path
    table: pd.DataFrame
    source_xy: NDArray[np.float64]
    """(2, FRAMES, 2, 2) pixels of the film: clip, frame, object."""

    def located(self, pixels: Pixels = "clip", scale: float | None = None) -> Located:
        return located("balls", self.path, self.table, self.clips, pixels, 3.0, scale)


def motion(frames: int) -> NDArray[np.float64]:
    """(T, K, 2) pixels of the film: object 0 moves on a line, 0.5 px right and 0.25 down a frame; 1 stands still."""
    t = np.arange(frames)[:, None]
    return np.stack([np.hstack([18 + 0.5 * t, 14 + 0.25 * t]), np.hstack([50 + 0 * t, 40 + 0 * t])], axis=1)


@pytest.fixture(scope="session")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Set:
    root = tmp_path_factory.mktemp("set")
    total = 2 * EVERY * FRAMES
    xy = motion(total)
    film = ball_film(xy, 4.0, 2)
    encoded(root / "raw" / "film.mkv", film, np.arange(total) / FILM_FPS)
    made, rows = [], []
    for part in range(2):
        source = np.arange(part * EVERY * FRAMES, (part + 1) * EVERY * FRAMES, EVERY, dtype=np.int32)
        small = np.stack([reframed(film[number], GEOMETRY) for number in source])
        times_s = np.arange(FRAMES) * EVERY / FILM_FPS
        name, ok = f"film_{part:02d}", np.full(FRAMES, "ok")
        split = ("train", "test")[part]
        made.append(Clip(name, split, "film.mkv", GEOMETRY, small, times_s, source, source / FILM_FPS, ok))
        found = GEOMETRY.to_clip(xy[source])
        found[LOST, 1] = np.nan
        rows.append(tracks.rows(name, times_s, found, np.full((FRAMES, 2), 0.75)))
    clips.save(root / "clips", made)
    clip_set = ClipSet(root / "clips")
    tracks.save(root / "tracks.parquet", pd.concat(rows), "made up", clip_set)
    table = tracks.load(root / "tracks.parquet")
    return Set(root / "raw", clip_set, root / "tracks.parquet", table, xy[::EVERY].reshape(2, FRAMES, 2, 2))
