"""`physpipe add`: film into the project, with values that fit it."""

import re
import shutil
import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physpipe.commands import section
from physpipe.commands.making import alone
from physpipe.commands.places import ANNOTATIONS, RAW
from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS
from physpipe.exporting.target import writable
from physpipe.health.asking import ask
from physpipe.health.wording import counted
from physpipe.ingest.framing import CropParams
from physpipe.io import adding, folders, params_file
from physpipe.io.annotations import REFERENCE, TEMPLATES
from physpipe.io.atomic import replacing
from physpipe.io.split_file import SPLIT_FILE
from physpipe.probing.advice import horizon
from physpipe.probing.crop import geometry
from physpipe.probing.folder import Probed, probe
from physpipe.probing.text import described

KEYS = {
    "source_fps": "ingest.source_fps",
    "fps": "ingest.fps",
    "crop": "ingest.crop",
    "clip_frames": "ingest.clip_frames",
    "objects": "motion.objects",
    "pixels_per_metre": "scale.pixels_per_metre",
}
"""Option to the key of the set's section that it gives."""


def run(words: Namespace) -> None:
    """Film into data/raw and DVC, tables into data/annotations, a section into params.yaml."""
    name = words.name
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise InputError(name, "not a name for a data set", "use letters, digits and _, a letter first")
    if not PARAMS.is_file():
        raise InputError(PARAMS, "no such file", "run from the project's root")
    had = section.exists(name)
    if had:
        _refuse_options(words)
    after = _params(words, had)
    raw, annotations = RAW / name, ANNOTATIONS / name
    with writable(raw), writable(annotations):
        found = adding.copy_film(words.folder, raw, annotations)
    with _undone_on_failure(raw, annotations), writable(PARAMS), replacing(PARAMS) as temporary:
        temporary.write_text(after, encoding="utf-8", newline="\n")
    what = "kept as it was" if had else "written: look through its values"
    print(f"{counted(len(found), 'recording')} in {raw}. Section `datasets.{name}` of {PARAMS} {what}.")
    _say_what_is_next(words, raw, annotations, _kept_by_dvc(raw))


def _refuse_options(words: Namespace) -> None:
    """Those that would go unheard, since the section stays as it is."""
    given = [option for option in KEYS if getattr(words, option) is not None]
    if given:
        options = ", ".join(f"--{option.replace('_', '-')}" for option in given)
        keys = ", ".join(f"`datasets.{words.name}.{KEYS[option]}`" for option in given)
        reason = f"the section `datasets.{words.name}` is there already and would be kept, without {options}"
        raise InputError(PARAMS, reason, f"set {keys} there and leave the options out, or choose another name")


def _params(words: Namespace, had: bool) -> str:
    """The text of params.yaml that is to be; raises InputError for values that do not fit."""
    probed = None if had else _probed(words)
    text = PARAMS.read_text(encoding="utf-8")
    text = section.extended(text, words.name, {} if had else _changes(words, probed))
    if words.crop and probed:
        _refuse_crop_outside(CropParams(**words.crop), probed)
    return params_file.with_item(text, "run.datasets", words.name) if words.run else text


def _probed(words: Namespace) -> Probed | None:
    """A look at the film; None where none is wanted, or it cannot be read, which ingest will name."""
    folders.recordings(words.folder)
    if words.no_probe:
        return None
    like = section.template()
    try:
        probed = probe(words.folder, like.size, like.split, words.source_fps)
    except InputError as error:
        print(
            f"The film cannot be looked at; values are those of `{section.TEMPLATE}`. {error}",
            file=sys.stderr,
        )
        return None
    print("\n".join(described(probed, like.size)), file=sys.stderr)
    return probed


def _changes(words: Namespace, probed: Probed | None) -> dict[str, Any]:
    """What differs from the template's section: what the user says, else what the film shows."""
    changes = {"ingest.fps": None, "ingest.source_fps": None, "ingest.crop": None}
    said = {key: getattr(words, option) for option, key in KEYS.items()}
    if words.clip_frames is not None:
        said |= {"ingest.min_frames": words.clip_frames, "predict.horizon": max(1, horizon(words.clip_frames))}
    seen = probed.advice.changes() if probed else {}
    return changes | seen | {key: value for key, value in said.items() if value is not None}


def _refuse_crop_outside(crop: CropParams, probed: Probed) -> None:
    for each in probed.found:
        try:
            geometry(each, crop, section.template().size)
        except InputError as error:
            raise InputError("--crop", f"{error.where}: {error.reason}", "give a box inside every frame") from None


@contextmanager
def _undone_on_failure(*copies: Path) -> Iterator[None]:
    """Film without its section would be in the way of the next try."""
    try:
        yield
    except BaseException:
        for folder in copies:
            shutil.rmtree(folder)
        raise


def _kept_by_dvc(raw: Path) -> bool:
    """Whether DVC took the film; says why not."""
    print(f"dvc add {raw.as_posix()} …", file=sys.stderr, flush=True)
    try:
        ask("dvc", "add", raw.as_posix())
    except InputError as error:
        print(f"The film is in place, but DVC does not keep it yet. {error}", file=sys.stderr)
        return False
    return True


def _say_what_is_next(words: Namespace, raw: Path, annotations: Path, kept: bool) -> None:
    name = words.name
    told = (raw / SPLIT_FILE).exists()
    shares = f"shares of `datasets.{name}.ingest.split`, whatever the folders are called; a {SPLIT_FILE} would decide"
    print(f"Train, valid and test: {raw / SPLIT_FILE if told else shares}.")
    if kept:
        print(f"DVC keeps the film; {raw.as_posix()}.dvc, which names it, belongs in Git.")
    print("Next:")
    if not kept:
        print(f"  dvc add {raw.as_posix()}")
    print("  dvc repro" if words.run else f"  {alone(name)}")
    if not (annotations / REFERENCE).exists() and not (words.folder / TEMPLATES).exists():
        print(f"To have errors measured, once it ran: physpipe annotate {name}")
