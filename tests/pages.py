"""The project's pages of documentation, taken apart."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"`([^`\n]+)`")


class Block(NamedTuple):
    """A fenced block."""

    language: str
    text: str
    before: str
    """The page from the fence before, or from its beginning, to this one."""


def blocks(page: Path, language: str | None = None, section: str | None = None) -> list[Block]:
    """The fenced blocks of a page in their order, or of its section under the heading `section`."""
    text, end, found = page.read_text(encoding="utf-8"), 0, []
    if section is not None:
        text = f"{text}\n## ".split(f"\n## {section}\n")[1].split("\n## ")[0]
    for match in FENCE.finditer(text):
        found.append(Block(match[1], match[2], text[end : match.start()]))
        end = match.end()
    return [each for each in found if language in (None, each.language)]


def prose(page: Path) -> str:
    """A page without its fenced blocks."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    assert "```" not in text, "a fence begins its line, and has one that ends it"
    return text


def spans(page: Path) -> list[str]:
    """The code spans of a page's prose."""
    text = prose(page)
    assert not [line for line in text.splitlines() if line.count("`") % 2], "a code span ends in the line it begins in"
    return SPAN.findall(text)
