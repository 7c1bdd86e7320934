"""The words of every command; nothing here is slow to import."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import shtab

Parser = argparse.ArgumentParser
FORMATS = ("csv", "mot", "trackpy", "movement")
FILMS = ("mp4", "webp")
PORT = 8765
SPLITS = ("train", "valid", "test")


class Command(NamedTuple):
    """What `--help` says of a command, and what adds its words; its module here has the same name, and a `run`."""

    about: str
    examples: str
    say: Callable[[Parser], None]


def _probe(words: Parser) -> None:
    _path(words, "folder", metavar="FOLDER", help="of videos or folders of images; stays as it is")
    words.add_argument("--source-fps", type=float, metavar="FPS", help="true rate, where times lie; images need it")
    words.add_argument("--name", help="of the section to print (default: the folder's)")
    _path(words, "--preview", metavar="PNG", help="contact sheet (default: probe_NAME.png here)")


def _add(words: Parser) -> None:
    words.add_argument("name", metavar="NAME", help="of the new data set")
    _path(words, "folder", metavar="FOLDER", help="of videos or folders of images; stays as it is")
    words.add_argument("--source-fps", type=float, metavar="FPS", help="true rate, where times lie; images need it")
    words.add_argument("--fps", type=float, help="rate of the clips (default: the film's own)")
    words.add_argument("--objects", type=int, metavar="N", help="number of objects (default: as many as are seen)")
    words.add_argument("--crop", type=_box, metavar="L,T,W,H", help="box in pixels (default: around what moves)")
    words.add_argument("--clip-frames", type=int, metavar="N", help="frames a clip (default: as gives enough clips)")
    words.add_argument("--pixels-per-metre", type=float, metavar="PX", help="of the film, for exports in metres")
    words.add_argument("--no-probe", action="store_true", help="take the example's values without a look at the film")
    words.add_argument("--run", action="store_true", help="append to `run.datasets`, for `dvc repro`")


def _doctor(words: Parser) -> None:
    """It takes no words."""


def _annotate(words: Parser) -> None:
    words.add_argument("name", metavar="NAME", help="of the data set")
    words.add_argument(
        "--port", type=int, default=PORT, help="of the page, on this machine alone (default: %(default)s)"
    )
    words.add_argument("--no-browser", dest="browser", action="store_false", help="print the address, open nothing")


def _export(words: Parser) -> None:
    words.add_argument("name", metavar="NAME", help="of the data set")
    words.add_argument("--to", required=True, choices=FORMATS, help="format; see docs/conventions.md")
    words.add_argument("--pixels", choices=("clip", "source"), default="clip", help="of the clips, or of the film")
    _path(words, "--table", metavar="PARQUET", help="another track table (default: the unsupervised tracks)")
    words.add_argument("--pixels-per-metre", type=float, metavar="PX", help="of the film (default: params.yaml's)")
    _path(words, "--out", metavar="FOLDER", help="new, or of an earlier export (default: exports/NAME/FORMAT)")


def _overlay(words: Parser) -> None:
    words.add_argument("name", metavar="NAME", help="of the data set")
    words.add_argument("--clips", nargs="+", metavar="CLIP", help="names (default: those of the split)")
    words.add_argument("--split", choices=(*SPLITS, "all"), default="test", help="clips to draw (default: test)")
    words.add_argument("--pixels", choices=("clip", "source"), default="clip", help="draw on the clips, or the film")
    words.add_argument("--predictor", help="whose forecasts (default: `report.predictor` of params.yaml)")
    _path(words, "--table", metavar="PARQUET", help="another track table (default: the unsupervised tracks)")
    words.add_argument("--slower", type=float, default=1.0, metavar="TIMES", help="than it was filmed (default: 1)")
    words.add_argument("--to", choices=FILMS, default="mp4", help="a film, or a picture that moves (default: mp4)")
    _path(words, "--out", metavar="FOLDER", help="new, or of an earlier overlay (default: exports/NAME/overlay)")


def _path(words: Parser, name: str, metavar: str, help: str) -> None:
    """A word for a path, which the shell completes."""
    word = words.add_argument(name, type=Path, metavar=metavar, help=help)
    word.complete = shtab.DIRECTORY if metavar == "FOLDER" else shtab.FILE  # type: ignore[attr-defined]


def _box(word: str) -> dict[str, int]:
    values = word.split(",")
    if len(values) != 4 or not all(value.strip().lstrip("-").isdecimal() for value in values):
        raise argparse.ArgumentTypeError("give left,top,width,height, four whole numbers of pixels")
    return dict(zip(("left", "top", "width", "height"), map(int, values), strict=True))


COMMANDS = {
    "probe": Command(
        "tell what a folder of film holds: rate, motion, objects, crop, what hurts",
        "physpipe probe ~/film\nphyspipe probe ~/slow_motion --source-fps 240 --name marbles --preview marbles.png",
        _probe,
    ),
    "add": Command(
        "add a folder of film as a data set",
        "physpipe add marbles ~/film\n"
        "physpipe add marbles ~/film --source-fps 240 --fps 80 --crop 420,0,1080,1080 --objects 2",
        _add,
    ),
    "doctor": Command(
        "check this machine and this project, and say what would run again",
        "physpipe doctor\nphyspipe doctor && dvc repro     runs only where nothing is in the way",
        _doctor,
    ),
    "annotate": Command(
        "check and correct a set's truth in the browser",
        "physpipe annotate marbles\nphyspipe annotate marbles --port 9000 --no-browser",
        _annotate,
    ),
    "export": Command(
        "write a set's tracks for other programs",
        "physpipe export bowls --to csv\n"
        "physpipe export marbles --to mot --pixels source --out ~/marbles_mot\n"
        "physpipe export marbles --to csv --table data/truth/marbles.parquet",
        _export,
    ),
    "overlay": Command(
        "draw tracks, truth and forecasts into films of the clips",
        "physpipe overlay bowls\n"
        "physpipe overlay marbles --pixels source --split train\n"
        "physpipe overlay bowls2 --clips clip_0007_00 clip_0009_00 --slower 4 --predictor linear\n"
        "physpipe overlay bowls2 --clips clip_0048_00 --to webp --slower 3 --out docs/film",
        _overlay,
    ),
}
