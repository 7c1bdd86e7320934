"""THE track table: truth, tracks and baselines alike, one row per clip, object and frame."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.io import tables
from physpipe.io.atomic import replacing_folder
from physpipe.io.clips import ClipSet

SCHEMA_VERSION = 1
KEY = ["clip", "object", "frame"]
AMBIGUOUS = "ambiguous"
"""Seen, but perhaps another object than the number says: objects that cross or touch."""
STATUSES = ("tracked", "lost", "corrected", "reference", AMBIGUOUS)
DTYPES = {
    "clip": "str",
    "object": "int16",
    "frame": "int32",
    "time_s": "float64",
    "x": "float32",
    "y": "float32",
    "score": "float32",
    "visible": "bool",
    "status": "str",
}


def empty() -> pd.DataFrame:
    """A track table with no rows, e.g. the truth of film that nobody annotated."""
    return pd.DataFrame({name: pd.Series(dtype=kind) for name, kind in DTYPES.items()})


def rows(
    clip: str,
    times_s: NDArray[np.float64],
    xy: NDArray[np.floating],
    score: NDArray[np.floating],
    status: str | NDArray[np.str_] = "tracked",
) -> pd.DataFrame:
    """Rows of one clip from `xy` (T, K, 2) pixels (NaN where lost), `score` (T, K) in [0, 1], `status` or (T, K) of it.

    A lost object has the status `lost` whatever is given for it.
    """
    T, K = xy.shape[:2]
    found = np.isfinite(xy).all(axis=2)
    columns = {
        "clip": clip,
        "object": np.repeat(np.arange(K, dtype=np.int16), T),
        "frame": np.tile(np.arange(T, dtype=np.int32), K),
        "time_s": np.tile(times_s, K),
        "x": np.where(found, xy[..., 0], np.nan).T.ravel(),
        "y": np.where(found, xy[..., 1], np.nan).T.ravel(),
        "score": np.where(found, score, 0).T.ravel(),
        "visible": found.T.ravel(),
        "status": np.where(found, status, "lost").T.ravel().astype(object),
    }
    return pd.DataFrame(columns).astype(DTYPES)


def positions(table: pd.DataFrame, clip: str) -> NDArray[np.float32]:
    """(T, K, 2) pixels of one clip, NaN where an object is not visible; raises KeyError when it has no rows."""
    mine = table[table["clip"] == clip]
    if mine.empty:
        raise KeyError(f"the track table has no clip {clip}")
    K = int(mine["object"].max()) + 1
    ordered = mine.sort_values(["frame", "object"])
    return ordered[["x", "y"]].to_numpy(np.float32).reshape(-1, K, 2)


def by_clip(table: pd.DataFrame) -> dict[str, NDArray[np.float32]]:
    """Clip name to (T, K, 2) pixels, for all clips of the table at once."""
    return {str(name): positions(mine, str(name)) for name, mine in table.groupby("clip", sort=True)}


def ambiguous(table: pd.DataFrame) -> dict[str, NDArray[np.bool_]]:
    """Clip name to (T, K), true where the status says that an object may have been mistaken for another."""
    ordered = table.assign(flag=table["status"] == AMBIGUOUS).sort_values(["clip", "frame", "object"])
    return {
        str(name): mine["flag"].to_numpy().reshape(-1, mine["object"].nunique())
        for name, mine in ordered.groupby("clip", sort=True)
    }


def object_count(path: Path, table: pd.DataFrame) -> int:
    """K, the number of objects in every clip; raises InputError naming `path` when clips differ or there are none."""
    counts = table.groupby("clip")["object"].nunique()
    found = sorted(set(counts.tolist()))
    if len(found) != 1:
        reason = f"clips with {found} objects" if found else "no tracks"
        raise InputError(path, reason, "track the same number of objects, at least one, in every clip")
    return found[0]


def save(path: Path, table: pd.DataFrame, producer: str, clips: ClipSet) -> None:
    """Checks, sorts and writes the table; schema version, producer and geometry go into the metadata."""
    table = table.astype(DTYPES).sort_values(KEY, ignore_index=True)
    check(path, table)
    about = {"version": SCHEMA_VERSION, "producer": producer, "geometry": _geometries(clips)}
    tables.write(path, table, about, categories=["status"])


def load(path: Path) -> pd.DataFrame:
    """Reads and checks a track table; raises InputError naming the file and the first bad row."""
    table = tables.read(path, DTYPES, "track table")
    table = table.astype(DTYPES)
    check(path, table)
    return table


def save_folder(folder: Path, tables: Mapping[str, pd.DataFrame], producer: str, clips: ClipSet) -> None:
    """Writes a table a tracker, `<tracker>.parquet`, into a folder that appears only when complete."""
    with replacing_folder(folder) as temporary:
        for name, table in tables.items():
            save(temporary / f"{name}.parquet", table, f"{producer} {name}", clips)


def load_folder(folder: Path) -> dict[str, pd.DataFrame]:
    """Tracker name to its table, in the order of names; raises InputError as `load` does."""
    if not folder.is_dir():
        raise InputError(folder, "no such folder", "run `dvc repro`, which makes it")
    return {path.stem: load(path) for path in sorted(folder.glob("*.parquet"))}


def check(path: Path, table: pd.DataFrame) -> None:
    """Raises InputError: repeated keys, gaps, scores beyond [0, 1], unknown statuses, positions that belie visible."""
    faults = {
        "repeats clip, object, frame": table.duplicated(KEY),
        f"has a status other than {', '.join(STATUSES)}": ~table["status"].isin(STATUSES),
        "has a score outside [0, 1]": ~table["score"].between(0, 1),
        "is visible without a position": table["visible"] & table[["x", "y"]].isna().any(axis=1),
        "has a position but is not visible": ~table["visible"] & table[["x", "y"]].notna().any(axis=1),
    }
    tables.refuse_rows(path, table, faults)
    spans = table.groupby(["clip", "object"])["frame"].agg(["min", "max", "size"])
    gaps = spans[(spans["min"] != 0) | (spans["max"] + 1 != spans["size"])]
    lengths = spans.groupby("clip")["size"].nunique()
    uneven = lengths[lengths > 1]
    if len(gaps) or len(uneven):
        clip = gaps.index[0][0] if len(gaps) else uneven.index[0]
        raise InputError(path, f"clip {clip} lacks rows", "keep a row a frame; a lost object keeps NaN rows")


def _geometries(clips: ClipSet) -> dict[str, list[float]]:
    first = clips.table.drop_duplicates("clip")
    fields = ["left", "top", "crop_width", "crop_height", "width", "height"]
    return {row["clip"]: [float(row[key]) for key in fields] for _, row in first.iterrows()}
