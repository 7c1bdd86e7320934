"""`physpipe overlay`: films with tracks drawn in."""

from argparse import Namespace

import pandas as pd

from physpipe.commands.making import made
from physpipe.commands.places import CLIPS, EXPORTS, FORECASTS, RAW, TRACKS, TRUTH, known_set
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.core.progress import progress
from physpipe.exporting import view
from physpipe.exporting.located import refuse_nothing_found
from physpipe.exporting.overlay import Tables, write_overlay
from physpipe.exporting.target import exported
from physpipe.health.wording import counted
from physpipe.io import forecasts, tracks
from physpipe.io.clips import ClipSet
from physpipe.report.params import ReportParams


def run(words: Namespace) -> None:
    """Writes `<clip>.mp4` (or another format) for every clip, and `about.json`."""
    name, shown = known_set(words.name), read("report", ReportParams)
    if not words.slower > 0:
        raise InputError("--slower", f"{words.slower:g} is no factor", "give a number above 0")
    path = made(words.table or TRACKS / f"{name}.parquet", name)
    track = tracks.load(path)
    refuse_nothing_found(path, track)
    tables = Tables(_truth(name), track, _forecast(name, words, shown.predictor, track))
    clips = ClipSet(made(CLIPS / name, name))
    names = [clip for clip in _names(clips, words) if (tables.track["clip"] == clip).any()]
    if not names:
        raise InputError(path, "no tracks of these clips", "choose others by --split or --clips")
    out = words.out or EXPORTS / name / "overlay"
    about = {"set": name, "pixels": words.pixels, "slower": words.slower, "tracks": path.as_posix()}
    with exported(out, about) as folder:
        for clip in progress(names, f"overlay {name}"):
            film = words.pixels == "source"
            on = view.of_film(clips, clip, RAW / name) if film else view.of_clip(clips, clip, shown.upscale)
            write_overlay(folder / f"{clip}.{words.to}", clips, clip, tables, on, shown.trail_frames, words.slower)
    print(f"{counted(len(names), 'film')}: {out}")


def _names(clips: ClipSet, words: Namespace) -> list[str]:
    if words.clips:
        return [clip for clip in words.clips if len(clips.rows(clip))]  # refuses an unknown one by name
    return clips.names() if words.split == "all" else clips.names(words.split)


def _truth(name: str) -> pd.DataFrame:
    path = TRUTH / f"{name}.parquet"
    return tracks.load(path) if path.is_file() else tracks.empty()


def _forecast(name: str, words: Namespace, usual: str, track: pd.DataFrame) -> pd.DataFrame:
    """Forecasts from the tracks; none where none were asked for, and there are none or another table is drawn."""
    path = FORECASTS / name / "tracks" / f"{words.predictor or usual}.parquet"
    if not words.predictor and (words.table or not path.is_file()):
        return forecasts.empty()
    table = forecasts.load(made(path, name))
    beyond = table.merge(track, on=forecasts.KEY, how="left")["visible"].isna() & table["clip"].isin(track["clip"])
    if beyond.any():
        reason = f"forecasts objects or frames of clip {table.loc[beyond, 'clip'].iloc[0]} that the tracks lack"
        raise InputError(path, reason, "draw the tracks that it was made from, without --table")
    return table
