"""The forecast table: one row per clip, object and frame that was asked for."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.io import tables

SCHEMA_VERSION = 1
KEY = ["clip", "object", "frame"]
DTYPES = {"clip": "str", "object": "int16", "frame": "int32", "x": "float32", "y": "float32"}
COVARIANCE = {"cov_xx": "float32", "cov_xy": "float32", "cov_yy": "float32"}
"""Square pixels; forecasts by what learned nothing, or sees the end, lack these columns."""


class ClipForecast(NamedTuple):
    """Consecutive frames of one clip."""

    first: int
    """Number of the first frame that was asked for."""
    mean: NDArray[np.float32]
    """(N, K, 2) pixels."""
    cov: NDArray[np.float32] | None
    """(N, K, 2, 2) square pixels."""


def empty() -> pd.DataFrame:
    """A forecast table with no rows."""
    return pd.DataFrame({name: pd.Series(dtype=kind) for name, kind in DTYPES.items()})


def rows(clip: str, first: int, mean: NDArray[np.floating], cov: NDArray[np.floating] | None = None) -> pd.DataFrame:
    """Rows of one clip from frame `first` on: `mean` (N, K, 2) px, `cov` (N, K, 2, 2) px^2."""
    N, K = mean.shape[:2]
    columns = {
        "clip": clip,
        "object": np.repeat(np.arange(K, dtype=np.int16), N),
        "frame": np.tile(np.arange(first, first + N, dtype=np.int32), K),
        "x": mean[..., 0].T.ravel(),
        "y": mean[..., 1].T.ravel(),
    }
    if cov is not None:
        parts = {"cov_xx": cov[..., 0, 0], "cov_xy": cov[..., 0, 1], "cov_yy": cov[..., 1, 1]}
        columns |= {name: part.T.ravel() for name, part in parts.items()}
    return pd.DataFrame(columns).astype(_types(list(columns)))


def by_clip(table: pd.DataFrame) -> dict[str, ClipForecast]:
    """Clip name to its forecast."""
    found = {}
    for name, mine in table.sort_values(["clip", "frame", "object"]).groupby("clip", sort=True):
        K = int(mine["object"].max()) + 1
        mean = mine[["x", "y"]].to_numpy(np.float32).reshape(-1, K, 2)
        cov = None
        if "cov_xx" in mine:
            square = mine[["cov_xx", "cov_xy", "cov_xy", "cov_yy"]].to_numpy(np.float32)
            cov = square.reshape(-1, K, 2, 2)
        found[str(name)] = ClipForecast(int(mine["frame"].min()), mean, cov)
    return found


def save(path: Path, table: pd.DataFrame, producer: str, seen_frames: int, horizon: int) -> None:
    """Checks, sorts and writes the table; `producer`, the frames seen and T go into the metadata."""
    table = table.astype(_types(list(table.columns))).sort_values(KEY, ignore_index=True)
    check(path, table)
    about = {"version": SCHEMA_VERSION, "producer": producer, "seen_frames": seen_frames, "horizon": horizon}
    tables.write(path, table, about)


def load(path: Path) -> pd.DataFrame:
    """Reads and checks a forecast table; raises InputError naming the file and the first bad row."""
    table = tables.read(path, DTYPES, "forecast table")
    table = table.astype(_types(list(table.columns)))
    check(path, table)
    return table


def check(path: Path, table: pd.DataFrame) -> None:
    """Raises InputError for repeated keys, gaps, positions that are not finite, covariances that are none."""
    faults = {
        "repeats clip, object, frame": table.duplicated(KEY),
        "has no finite position": ~np.isfinite(table[["x", "y"]]).all(axis=1),
    }
    if "cov_xx" in table:
        determinant = table["cov_xx"] * table["cov_yy"] - table["cov_xy"] ** 2
        faults["has no positive covariance"] = ~((table["cov_xx"] > 0) & (determinant > 0))
    tables.refuse_rows(path, table, faults)
    spans = table.groupby(["clip", "object"])["frame"].agg(["min", "max", "size"])
    gaps = spans[spans["max"] - spans["min"] + 1 != spans["size"]]
    uneven = spans.groupby("clip")[["min", "max"]].nunique().max(axis=1) > 1
    if len(gaps) or uneven.any():
        clip = gaps.index[0][0] if len(gaps) else uneven.index[uneven][0]
        raise InputError(path, f"clip {clip} lacks rows", "keep a row for every object and frame asked for")


def _types(columns: list[str]) -> dict[str, str]:
    return {**DTYPES, **(COVARIANCE if "cov_xx" in columns else {})}
