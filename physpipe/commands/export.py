"""`physpipe export`: tracks for other programs."""

from pathlib import Path

from physpipe.commands.places import CLIPS, EXPORTS, TRACKS, known_set
from physpipe.commands.words import Commands, Words, command, out_of
from physpipe.core.ball import BallParams
from physpipe.core.params import read
from physpipe.exporting.formats import FORMATS
from physpipe.exporting.located import located
from physpipe.exporting.scale import pixels_per_metre
from physpipe.exporting.target import exported
from physpipe.io import tracks
from physpipe.io.clips import ClipSet

EXAMPLES = """\
physpipe export bowls --to csv
physpipe export marbles --to mot --pixels source --out ~/marbles_mot
physpipe export marbles --to csv --table data/truth/marbles.parquet"""


def register(commands: Commands) -> None:
    """Adds the words of this command."""
    words = command(commands, "export", "write a set's tracks for other programs", EXAMPLES)
    words.set_defaults(command=run)
    words.add_argument("name", metavar="NAME", help="of the data set")
    words.add_argument("--to", required=True, choices=list(FORMATS), help="format; see docs/conventions.md")
    words.add_argument("--pixels", choices=("clip", "source"), default="clip", help="of the clips, or of the film")
    words.add_argument("--table", type=Path, help="another track table of the set (default: the unsupervised tracks)")
    words.add_argument("--pixels-per-metre", type=float, help="in the film (default: as in params.yaml)")
    out_of(words, f"{EXPORTS / 'NAME' / 'FORMAT'}")


def run(words: Words) -> None:
    """Writes a folder with the tracks and `about.json`."""
    name = known_set(words.name)
    path = words.table or TRACKS / f"{name}.parquet"
    scale = words.pixels_per_metre or pixels_per_metre(name)
    radius_px = read(f"datasets.{name}.evaluate", BallParams).ball_radius_px
    found = located(name, path, tracks.load(path), ClipSet(CLIPS / name), words.pixels, radius_px, scale)
    out = words.out or EXPORTS / name / words.to
    with exported(out, found.about(words.to, path)) as folder:
        FORMATS[words.to](folder, found)
    clips, rows = found.table["clip"].nunique(), len(found.table)
    units = f", metres at {scale:g} px per metre" if scale else ""
    print(f"{clips} clips, {rows} rows in {words.pixels} pixels{units}: {out}")
