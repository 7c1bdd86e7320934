"""`physpipe export`: tracks for other programs."""

from argparse import Namespace

from physpipe.commands.making import made
from physpipe.commands.places import CLIPS, EXPORTS, TRACKS, known_set
from physpipe.core.ball import BallParams
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.exporting.formats import FORMATS
from physpipe.exporting.located import located
from physpipe.exporting.scale import pixels_per_metre
from physpipe.exporting.target import exported
from physpipe.health.wording import counted
from physpipe.io import tracks
from physpipe.io.clips import ClipSet


def run(words: Namespace) -> None:
    """Writes a folder with the tracks and `about.json`."""
    name = known_set(words.name)
    if words.pixels_per_metre is not None and not words.pixels_per_metre > 0:
        raise InputError("--pixels-per-metre", f"{words.pixels_per_metre:g} is no scale", "give a number above 0")
    path = made(words.table or TRACKS / f"{name}.parquet", name)
    scale = words.pixels_per_metre or pixels_per_metre(name)
    radius_px = read(f"datasets.{name}.evaluate", BallParams).ball_radius_px
    found = located(name, path, tracks.load(path), ClipSet(made(CLIPS / name, name)), words.pixels, radius_px, scale)
    out = words.out or EXPORTS / name / words.to
    with exported(out, found.about(words.to, path)) as folder:
        FORMATS[words.to](folder, found)
    clips, rows = counted(found.table["clip"].nunique(), "clip"), counted(len(found.table), "row")
    units = f", metres at {scale:g} px per metre" if scale else ""
    print(f"{clips}, {rows} in {words.pixels} pixels{units}: {out}")
