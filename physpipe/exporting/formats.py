"""The formats that tracks are exported in, each one function that writes into a folder."""

from collections.abc import Callable
from configparser import ConfigParser
from pathlib import Path

import pandas as pd

from physpipe.core.progress import progress
from physpipe.exporting.located import METRES, Located

MOT_COLUMNS = ["frame", "id", "left", "top", "width", "height", "confidence", "x_m", "y_m", "z_m"]
UNKNOWN = -1
"""MOT's word for what is not known."""
POINT = "centre"
"""Name of the one point that an object has."""


def write_csv(folder: Path, tracks: Located) -> None:
    """`tracks.csv`: every row of the table, lost objects without a position."""
    _save(folder / "tracks.csv", tracks.table)


def write_trackpy(folder: Path, tracks: Located) -> None:
    """`trackpy.csv`: a row a position; `particle` numbers the objects of all clips together."""
    rows = tracks.counted
    rows = rows.assign(particle=rows.groupby(["clip", "object"], sort=True).ngroup())
    columns = ["frame", "particle", "y", "x", "score", "clip", *[each for each in METRES if each in rows]]
    _save(folder / "trackpy.csv", rows[columns].sort_values(["particle", "frame"]))


def write_mot(folder: Path, tracks: Located) -> None:
    """`<clip>.txt`, MOTChallenge's ten columns, and `<clip>/seqinfo.ini`, for each clip.

    Frames, ids and pixels count from 1 there; a box is as wide and high as the object.
    """
    counted = tracks.counted
    for clip in progress(tracks.table["clip"].unique(), f"export {tracks.name}"):
        rows = counted[counted["clip"] == clip].sort_values(["frame", "object"])
        _save(folder / f"{clip}.txt", _boxes(rows, tracks, str(clip)), header=False)
        _write_sequence(folder / clip / "seqinfo.ini", tracks, str(clip))


def _boxes(rows: pd.DataFrame, tracks: Located, clip: str) -> pd.DataFrame:
    width, height = (2 * tracks.radius_px * each for each in tracks.pixels_per_clip_pixel(clip))
    # A box of one pixel has that pixel's centre: the first pixel is 0 for us and 1 for MOT.
    values = {
        "frame": rows["frame"] + 1,
        "id": rows["object"] + 1,
        "left": rows["x"] - (width - 1) / 2 + 1,
        "top": rows["y"] - (height - 1) / 2 + 1,
        "width": width,
        "height": height,
        "confidence": rows["score"],
        "x_m": rows.get("x_m", UNKNOWN),
        "y_m": rows.get("y_m", UNKNOWN),
        "z_m": UNKNOWN,
    }
    return pd.DataFrame(values, index=rows.index)[MOT_COLUMNS]


def _write_sequence(path: Path, tracks: Located, clip: str) -> None:
    """What MOTChallenge says of a sequence; the size of a whole recording's frame is not kept with the clips."""
    rows = tracks.clips.rows(clip)
    about = {"name": clip, "frameRate": f"{tracks.fps(clip):g}", "seqLength": str(tracks.last_frame(clip) + 1)}
    if tracks.pixels == "clip":
        about |= {"imWidth": str(rows["width"].iloc[0]), "imHeight": str(rows["height"].iloc[0])}
    parser = ConfigParser()
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    parser["Sequence"] = about
    path.parent.mkdir()
    with path.open("w", encoding="utf-8") as file:
        parser.write(file, space_around_delimiters=False)


def write_movement(folder: Path, tracks: Located) -> None:
    """`<clip>.csv` as DeepLabCut lays it out, which every version of movement loads (netCDF's names changed).

    A row a frame of the clip, a lost object without a position and with likelihood 0.
    """
    by_clip = tracks.table.groupby("clip")
    for clip, rows in progress(by_clip, f"export {tracks.name}", len(by_clip)):
        parts = {
            ("physpipe", f"object_{number}", POINT, name): mine.set_index("frame")[column].to_numpy()
            for number, mine in rows.groupby("object")
            for name, column in (("x", "x"), ("y", "y"), ("likelihood", "score"))
        }
        table = pd.DataFrame(parts)
        table.columns = table.columns.set_names(["scorer", "individuals", "bodyparts", "coords"])
        _save(folder / f"{clip}.csv", table, index=True)


FORMATS: dict[str, Callable[[Path, Located], None]] = {
    "csv": write_csv,
    "mot": write_mot,
    "trackpy": write_trackpy,
    "movement": write_movement,
}


def _save(path: Path, table: pd.DataFrame, header: bool = True, index: bool = False) -> None:
    """Eight significant digits: a hundredth of a pixel of the largest film, a microsecond of a day's."""
    table.to_csv(path, header=header, index=index, float_format="%.8g", lineterminator="\n")
