"""`physpipe probe`: what is in a folder of film, and what will hurt."""

import re
import shlex
from argparse import Namespace
from pathlib import Path

from physpipe.commands import section
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
    free = f"{name}_2" if section.exists(name) else name
    rate = f" --source-fps {words.source_fps:g}" if words.source_fps else ""
    added = f"physpipe add {free} {shlex.quote(str(words.folder))}{rate}"
    print(f"\nThe section for `datasets` in {PARAMS}, where `{added}` puts it:\n")
    print(section.block(free, probed.advice.changes()))


def _name(folder: Path) -> str:
    """The folder's, made fit for a data set."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", folder.resolve().name).strip("_")
    return plain if plain[:1].isalpha() else f"film_{plain}"
