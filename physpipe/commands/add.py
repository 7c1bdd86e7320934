"""`physpipe add`: film into the project, with values that fit it."""

import re
import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from physpipe.commands import section
from physpipe.commands.places import ANNOTATIONS, RAW
from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS
from physpipe.io import adding, folders, params_file
from physpipe.io.annotations import REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing
from physpipe.io.split_file import SPLIT_FILE
from physpipe.probing.advice import horizon
from physpipe.probing.folder import probe
from physpipe.probing.text import described


def run(words: Namespace) -> None:
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
    raw, annotations = RAW / name, ANNOTATIONS / name
    found = adding.copy_film(words.folder, raw, annotations)
    with replacing(PARAMS) as temporary:
        temporary.write_text(after, encoding="utf-8", newline="\n")
    what = "kept as it was" if had else "written: look through its values"
    print(f"{len(found)} recordings in {raw}. Section `datasets.{name}` of {PARAMS} {what}.")
    _say_what_is_next(words, raw, annotations)


def _say_what_is_next(words: Namespace, raw: Path, annotations: Path) -> None:
    name = words.name
    told = (raw / SPLIT_FILE).exists()
    shares = f"shares of `datasets.{name}.ingest.split`, whatever the folders are called; a {SPLIT_FILE} would decide"
    print(f"Train, valid and test: {raw / SPLIT_FILE if told else shares}.\nNext:")
    print(f"  dvc add {raw}")
    alone = f'dvc exp run -S "run.datasets=[{name}]" -S "run.simulated=[]" -S "run.supervised=[]"'
    print("  dvc repro" if words.run else f"  {alone}")
    if not (annotations / REFERENCE).exists() and not (words.folder / TEMPLATES).exists():
        print(f"To have errors measured, put boxes into {annotations / TEMPLATES} (clip names: data/clips/{name}).")


def _changes(words: Namespace) -> dict[str, Any]:
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


def _seen(words: Namespace) -> dict[str, Any]:
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
