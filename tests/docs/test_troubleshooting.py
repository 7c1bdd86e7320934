"""Every message that docs/troubleshooting.md quotes is one of ours, or of DVC where the page says so."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs/troubleshooting.md"
OPEN = "…"
"""What the page writes for a name or a figure."""
MADE_OF = re.compile(r"…|\. To mend: |: line |^…: ")
"""What stands between the parts of a message: `InputError` puts three together, `annotations` adds a line's number."""


def said_in(file: Path) -> Iterator[str]:
    """Every text that a Python file holds, what is filled in left open."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(each.value) if isinstance(each, ast.Constant) else OPEN for each in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


@cache
def ours() -> list[str]:
    """The texts of each of our files, one after the other."""
    code = [*(ROOT / "physpipe").rglob("*.py"), *(ROOT / "stages").glob("*.py")]
    pages = [
        re.sub(r"\s+", " ", path.read_text(encoding="utf-8")) for path in (ROOT / "physpipe/report").rglob("*.html")
    ]
    return ["\n".join(said_in(path)) for path in code] + pages


@cache
def of_dvc() -> list[str]:
    """The same of DVC's packages; the second speaks with Git."""
    folders = [Path(find_spec(name).submodule_search_locations[0]) for name in ("dvc", "scmrepo")]
    return ["\n".join(said_in(path)) for folder in folders for path in folder.rglob("*.py")]


def parts(message: str) -> list[str]:
    """What of a message must stand in the sources, word for word."""
    return [each.strip(" :.") for each in MADE_OF.split(message) if len(each.strip(" :.(),%")) > 2]


def quoted(language: str) -> list[str]:
    return [line for block in blocks(PAGE, language) for line in block.text.splitlines()]


@pytest.mark.parametrize("message", quoted("text"))
def test_a_message_is_said_by_one_of_our_files(message):
    assert any(all(part in text for part in parts(message)) for text in ours()), parts(message)


@pytest.mark.parametrize("message", quoted("console"))
def test_a_message_of_dvc_is_said_by_it(message):
    assert any(all(part in text for part in parts(message)) for text in of_dvc()), parts(message)


def test_a_message_falls_into_what_is_always_said():
    assert parts("…: no clip `…` there. To mend: use another") == ["no clip `", "` there", "use another"]
    assert parts("no such clip: line …") == ["no such clip"]
    assert not any("no such message" in text for text in ours())
