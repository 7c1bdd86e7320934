"""The command `physpipe`: what is done by hand around the pipeline."""

import argparse
import re
import sys
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS
from physpipe.ingest.dataset import IngestParams
from physpipe.io import adding, params_file
from physpipe.io.annotations import REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing
from physpipe.io.split_file import SPLIT_FILE

TEMPLATE = "pendulum"
EXAMPLE = "example: physpipe add marbles ~/film --source-fps 240 --fps 80 --crop 420,0,1080,1080 --objects 2"
PORT = 8765


def main() -> None:
    """Runs one command; a user's mistake ends as one line, not a traceback."""
    words = _parser().parse_args()
    try:
        words.command(words)
    except InputError as error:
        sys.exit(f"error: {error}")


def add(words: argparse.Namespace) -> None:
    """Film into data/raw, tables into data/annotations, a section into params.yaml."""
    name = words.name
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise InputError(name, "not a name for a data set", "use letters, digits and _, a letter first")
    if not PARAMS.is_file():
        raise InputError(PARAMS, "no such file", "run from the project's root")
    before = PARAMS.read_text()
    after = _extended(before, name, words)
    raw, annotations = Path("data/raw") / name, Path("data/annotations") / name
    found = adding.copy_film(words.folder, raw, annotations)
    with replacing(PARAMS) as temporary:
        temporary.write_text(after)
    had = name in yaml.safe_load(before)["datasets"]
    section = "kept as it was" if had else f"copied from `{TEMPLATE}`: look through its other values"
    print(f"{len(found)} recordings in {raw}. Section `datasets.{name}` of {PARAMS} {section}.")
    told = (raw / SPLIT_FILE).exists()
    shares = f"shares of `datasets.{name}.ingest.split`, whatever the folders are called; a {SPLIT_FILE} would decide"
    print(f"Train, valid and test: {raw / SPLIT_FILE if told else shares}.\nNext:")
    print(f"  dvc add {raw}")
    alone = f"dvc exp run -S 'run.datasets=[{name}]' -S 'run.simulated=[]' -S 'run.supervised=[]'"
    print("  dvc repro" if words.run else f"  {alone}")
    if not (annotations / REFERENCE).exists() and not (words.folder / TEMPLATES).exists():
        print(f"To have errors measured, put boxes into {annotations / TEMPLATES} (clip names: data/clips/{name}).")


def annotate(words: argparse.Namespace) -> None:
    """Template boxes and corrections in the browser, into data/annotations."""
    from physpipe.annotator import serving  # a web server, for which no other command should wait

    place = Path("data/annotations") / words.name
    serving.annotate(words.name, Path("data/clips") / words.name, place, words.port, words.browser)


def _extended(text: str, name: str, words: argparse.Namespace) -> str:
    """params.yaml's text with the new data set; raises InputError for values that ingest would refuse."""
    extended = params_file.with_section(text, "datasets", TEMPLATE, name, _changes(words))
    if words.run:
        extended = params_file.with_item(extended, "run.datasets", name)
    try:
        IngestParams.model_validate(yaml.safe_load(extended)["datasets"][name]["ingest"])
    except ValidationError as error:
        faults = [f"`{'.'.join(map(str, each['loc']))}`: {each['msg']}" for each in error.errors()]
        raise InputError(PARAMS, f"ingest would refuse {'; '.join(faults)}", "correct the options") from None
    return extended


def _changes(words: argparse.Namespace) -> dict[str, Any]:
    """What differs from the template's section: its box and rates are of its own film."""
    changes = {"ingest.fps": words.fps, "ingest.source_fps": words.source_fps, "ingest.crop": words.crop}
    if words.clip_frames is not None:
        changes["ingest.clip_frames"] = words.clip_frames
        changes["ingest.min_frames"] = words.clip_frames
    if words.objects is not None:
        changes["motion.objects"] = words.objects
    return changes


def _crop(word: str) -> dict[str, int]:
    values = word.split(",")
    if len(values) != 4:
        raise argparse.ArgumentTypeError("give left,top,width,height")
    return dict(zip(("left", "top", "width", "height"), map(int, values), strict=True))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="physpipe", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("add", help="add a folder of film as a data set", epilog=EXAMPLE)
    command.set_defaults(command=add)
    command.add_argument("name", metavar="NAME", help="of the new data set")
    command.add_argument("folder", metavar="FOLDER", type=Path, help="of videos or folders of images; stays as it is")
    command.add_argument("--source-fps", type=float, help="true rate, where the timestamps lie; images need it")
    command.add_argument("--fps", type=float, help="rate of the clips (default: the film's own)")
    command.add_argument("--objects", type=int, help=f"number of objects (default: as in `{TEMPLATE}`)")
    command.add_argument("--crop", type=_crop, metavar="L,T,W,H", help="box in pixels (default: centred square)")
    command.add_argument("--clip-frames", type=int, help=f"frames a clip (default: as in `{TEMPLATE}`)")
    command.add_argument("--run", action="store_true", help="append to `run.datasets`, for `dvc repro`")
    command = commands.add_parser(
        "annotate", help="check and correct a set's truth in the browser", epilog="example: physpipe annotate marbles"
    )
    command.set_defaults(command=annotate)
    command.add_argument("name", metavar="NAME", help="of a filmed data set whose clips are made (`dvc repro`)")
    command.add_argument("--port", type=int, default=PORT, help=f"of the page, on this machine alone (default: {PORT})")
    command.add_argument("--no-browser", dest="browser", action="store_false", help="print the address, open nothing")
    return parser


if __name__ == "__main__":
    main()
