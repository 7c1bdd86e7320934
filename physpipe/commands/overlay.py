"""`physpipe overlay`: films with tracks drawn in."""

from pathlib import Path

import pandas as pd

from physpipe.commands.places import CLIPS, EXPORTS, FORECASTS, RAW, TRACKS, TRUTH, known_set
from physpipe.commands.words import Commands, Words, command, out_of
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.core.progress import progress
from physpipe.exporting import view
from physpipe.exporting.overlay import Tables, write_overlay
from physpipe.exporting.target import exported
from physpipe.io import forecasts, tracks
from physpipe.io.clips import SPLITS, ClipSet
from physpipe.report.page import ReportParams

EXAMPLES = """\
physpipe overlay bowls
physpipe overlay marbles --pixels source --split train
physpipe overlay bowls2 --clips clip_0007_00 clip_0009_00 --slower 4 --predictor linear"""


def register(commands: Commands) -> None:
    """Adds the words of this command."""
    words = command(commands, "overlay", "draw tracks, truth and forecasts into films of the clips", EXAMPLES)
    words.set_defaults(command=run)
    words.add_argument("name", metavar="NAME", help="of the data set")
    words.add_argument("--clips", nargs="+", metavar="CLIP", help="names (default: the test clips)")
    words.add_argument("--split", choices=(*SPLITS, "all"), default="test", help="clips to draw (default: test)")
    words.add_argument("--pixels", choices=("clip", "source"), default="clip", help="draw on the clips, or on the film")
    words.add_argument("--predictor", help="whose forecasts (default: `report.predictor` of params.yaml)")
    words.add_argument("--table", type=Path, help="another track table of the set (default: the unsupervised tracks)")
    words.add_argument("--slower", type=float, default=1.0, help="times slower than filmed (default: 1)")
    out_of(words, f"{EXPORTS / 'NAME' / 'overlay'}")


def run(words: Words) -> None:
    """Writes `<clip>.mp4` for every clip, and `about.json`."""
    name, shown = known_set(words.name), read("report", ReportParams)
    if not words.slower > 0:
        raise InputError("--slower", f"{words.slower:g} is no factor", "give a number above 0")
    path = words.table or TRACKS / f"{name}.parquet"
    tables = Tables(_truth(name), tracks.load(path), _forecast(name, words.predictor, shown.predictor))
    clips = ClipSet(CLIPS / name)
    names = [clip for clip in _names(clips, words) if (tables.track["clip"] == clip).any()]
    if not names:
        raise InputError(path, "no tracks of these clips", "choose others by --split or --clips")
    out = words.out or EXPORTS / name / "overlay"
    about = {"set": name, "pixels": words.pixels, "slower": words.slower, "tracks": path.as_posix()}
    with exported(out, about) as folder:
        for clip in progress(names, f"overlay {name}"):
            film = words.pixels == "source"
            on = view.of_film(clips, clip, RAW / name) if film else view.of_clip(clips, clip, shown.upscale)
            write_overlay(folder / f"{clip}.mp4", clips, clip, tables, on, shown.trail_frames, words.slower)
    print(f"{len(names)} films: {out}")


def _names(clips: ClipSet, words: Words) -> list[str]:
    if words.clips:
        return [clip for clip in words.clips if len(clips.rows(clip))]  # refuses an unknown one by name
    return clips.names() if words.split == "all" else clips.names(words.split)


def _truth(name: str) -> pd.DataFrame:
    path = TRUTH / f"{name}.parquet"
    return tracks.load(path) if path.is_file() else tracks.empty()


def _forecast(name: str, asked: str | None, usual: str) -> pd.DataFrame:
    """Forecasts from the tracks; none where nothing was asked for and nothing was forecast."""
    path = FORECASTS / name / "tracks" / f"{asked or usual}.parquet"
    return forecasts.load(path) if asked or path.is_file() else forecasts.empty()
