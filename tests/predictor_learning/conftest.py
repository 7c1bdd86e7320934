"""Balls in free fall, for the tests of predictors."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.core.geometry import Geometry
from physpipe.io import clips, tracks
from physpipe.io.clips import Clip, ClipSet

HEIGHT, WIDTH = 32, 48
SPLITS = ("train", "train", "valid", "test", "test")


def falling(
    folder: Path, lengths: tuple[int, ...] = (16, 16, 16, 30, 20), objects: int = 1
) -> tuple[ClipSet, pd.DataFrame]:
    """Two training clips, one to validate, two to test: (10 + n, 4) + (0.3, 0) t + (0, 0.01) t^2 px; noise for film."""
    films, tables = [], []
    for n, (length, split) in enumerate(zip(lengths, SPLITS, strict=True)):
        t = np.arange(length)
        xy = np.stack([10 + n + 0.3 * t, 4 + 0.01 * t**2], axis=1)[:, None] + 5 * np.arange(objects)[:, None]
        frames = np.random.default_rng(n).integers(0, 255, (length, HEIGHT, WIDTH, 3), dtype=np.uint8)
        geometry = Geometry(0, 0, WIDTH, HEIGHT, WIDTH, HEIGHT)
        ok = np.full(length, "ok")
        films.append(Clip(f"c{n}", split, "f", geometry, frames, t / 80, t.astype(np.int32), t / 80, ok))
        tables.append(tracks.rows(f"c{n}", t / 80, xy, np.ones((length, objects))))
    clips.save(folder, films)
    return ClipSet(folder), pd.concat(tables)


@pytest.fixture
def falling_balls(tmp_path: Path) -> Callable[..., tuple[ClipSet, pd.DataFrame]]:
    """`falling` in a folder of the test's own."""
    return lambda **how: falling(tmp_path / "set", **how)
