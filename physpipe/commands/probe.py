"""`physpipe probe`: what is in a folder of film, and what will hurt."""

import re
import shlex
from argparse import Namespace
from collections.abc import Iterator
from itertools import chain, count
from pathlib import Path

from physpipe.commands import section
from physpipe.commands.places import ANNOTATIONS, RAW
from physpipe.core.params import PARAMS
from physpipe.exporting.target import writable
from physpipe.probing import sheet
from physpipe.probing.crop import geometry
from physpipe.probing.folder import probe
from physpipe.probing.text import described


def run(words: Namespace) -> None:
    """Prints what was found and the section to paste, writes the contact sheet."""
    like = section.template()
    name = words.name or _name(words.folder)
    probed = probe(words.folder, like.size, like.split, words.source_fps)
    crop = probed.advice.crop
    preview = words.preview or Path(f"probe_{name}.png")
    with writable(preview):
        sheet.save(preview, probed.found, [geometry(each, crop, like.size) for each in probed.found])
    print("\n".join(described(probed, like.size)))
    print(f"The likely crop and what moves: {preview}")
    folder = shlex.quote(str(words.folder))
    if section.exists(name) and not _filmed(name):
        print(f"\n`physpipe add {name} {folder}` gives this film to the section `datasets.{name}` that {PARAMS} has.")
    free = next(each for each in _names(name) if not section.exists(each) and not _filmed(each))
    rate = f" --source-fps {words.source_fps:g}" if words.source_fps else ""
    print(f"\nThe section for `datasets` in {PARAMS}, where `physpipe add {free} {folder}{rate}` puts it:\n")
    print(section.block(free, probed.advice.changes()))


def _filmed(name: str) -> bool:
    """Whether `add` would find something in its way."""
    return any((place / name).exists() for place in (RAW, ANNOTATIONS))


def _names(name: str) -> Iterator[str]:
    """The name, then the same with a number."""
    return chain([name], (f"{name}_{number}" for number in count(2)))


def _name(folder: Path) -> str:
    """The folder's, made fit for a data set."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", folder.resolve().name).strip("_")
    return plain if plain[:1].isalpha() else f"film_{plain}"
