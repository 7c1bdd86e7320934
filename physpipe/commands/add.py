"""`physpipe add`: film into the project, with values that fit it."""

import argparse
import re
import sys
from pathlib import Path
from typing import Any

import shtab

from physpipe.commands import section
from physpipe.commands.words import Commands, Words, command
from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS
from physpipe.io import adding, folders, params_file
from physpipe.io.annotations import REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing
from physpipe.io.split_file import SPLIT_FILE
from physpipe.probing.advice import horizon
from physpipe.probing.folder import probe
from physpipe.probing.text import described

EXAMPLES = """\
physpipe add marbles ~/film
physpipe add marbles ~/film --source-fps 240 --fps 80 --crop 420,0,1080,1080 --objects 2"""


def register(commands: Commands) -> None:
    """Adds the words of this command."""
    words = command(commands, "add", "add a folder of film as a data set", EXAMPLES)
    words.set_defaults(command=run)
    words.add_argument("name", metavar="NAME", help="of the new data set")
    folder = words.add_argument("folder", metavar="FOLDER", type=Path, help="of videos or images; stays as it is")
    folder.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    words.add_argument("--source-fps", type=float, help="true rate, where the timestamps lie; images need it")
    words.add_argument("--fps", type=float, help="rate of the clips (default: the film's own)")
    words.add_argument("--objects", type=int, help="number of objects (default: as many as are seen)")
    words.add_argument("--crop", type=_crop, metavar="L,T,W,H", help="box in pixels (default: around what moves)")
    words.add_argument("--clip-frames", type=int, help="frames a clip (default: as long as gives enough clips)")
    words.add_argument("--no-probe", action="store_true", help=f"take the values of `{section.TEMPLATE}` unseen")
    words.add_argument("--pixels-per-metre", type=float, help="of the film, in the plane of the motion, for exports")
    words.add_argument("--run", action="store_true", help="append to `run.datasets`, for `dvc repro`")


def run(words: Words) -> None:
    """Film into data/raw, tables into data/annotations, a section into params.yaml."""
    name = words.name
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise InputError(name, "not a name for a data set", "use letters, digits and _, a letter first")
    if not PARAMS.is_file():
        raise InputError(PARAMS, "no such file", "run from the project's root")
    had = section.exists(name)
    before = PARAMS.read_text(encoding="utf-8")
    after = section.extended(before, name, {} if had else _changes(words))
    if words.run:
        after = params_file.with_item(after, "run.datasets", name)
    raw, annotations = Path("data/raw") / name, Path("data/annotations") / name
    found = adding.copy_film(words.folder, raw, annotations)
    with replacing(PARAMS) as temporary:
        temporary.write_text(after, encoding="utf-8", newline="\n")
    what = "kept as it was" if had else "written: look through its values"
    print(f"{len(found)} recordings in {raw}. Section `datasets.{name}` of {PARAMS} {what}.")
    _say_what_is_next(words, raw, annotations)


def _say_what_is_next(words: Words, raw: Path, annotations: Path) -> None:
    name = words.name
    told = (raw / SPLIT_FILE).exists()
    shares = f"shares of `datasets.{name}.ingest.split`, whatever the folders are called; a {SPLIT_FILE} would decide"
    print(f"Train, valid and test: {raw / SPLIT_FILE if told else shares}.\nNext:")
    print(f"  dvc add {raw}")
    alone = f"dvc exp run -S 'run.datasets=[{name}]' -S 'run.simulated=[]' -S 'run.supervised=[]'"
    print("  dvc repro" if words.run else f"  {alone}")
    if not (annotations / REFERENCE).exists() and not (words.folder / TEMPLATES).exists():
        print(f"To have errors measured, put boxes into {annotations / TEMPLATES} (clip names: data/clips/{name}).")


def _changes(words: Words) -> dict[str, Any]:
    """What differs from the template's section: what the user says, else what the film shows."""
    changes = {"ingest.fps": None, "ingest.source_fps": None, "ingest.crop": None} | _seen(words)
    said = {"ingest.fps": words.fps, "ingest.source_fps": words.source_fps, "ingest.crop": words.crop}
    said |= {"motion.objects": words.objects, "ingest.clip_frames": words.clip_frames}
    said["scale.pixels_per_metre"] = words.pixels_per_metre
    if words.clip_frames is not None:
        said["ingest.min_frames"] = words.clip_frames
        if "predict.horizon" in changes:
            said["predict.horizon"] = horizon(words.clip_frames)
    return changes | {key: value for key, value in said.items() if value is not None}


def _seen(words: Words) -> dict[str, Any]:
    """What a look at the film suggests; nothing where it cannot be read, which ingest will name."""
    folders.recordings(words.folder)
    if words.no_probe:
        return {}
    like = section.template()
    try:
        probed = probe(words.folder, like.size, like.split, words.source_fps)
    except InputError as error:
        print(
            f"The film cannot be looked at; values are those of `{section.TEMPLATE}`. {error}",
            file=sys.stderr,
        )
        return {}
    print("\n".join(described(probed, like.size)), file=sys.stderr)
    return probed.advice.changes()


def _crop(word: str) -> dict[str, int]:
    values = word.split(",")
    if len(values) != 4:
        raise argparse.ArgumentTypeError("give left,top,width,height")
    return dict(zip(("left", "top", "width", "height"), map(int, values), strict=True))
