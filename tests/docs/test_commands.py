"""Every command that README and docs show can be run: its words are known to whoever reads them."""

import importlib.util
import re
import shlex
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
import yaml
from dvc.cli import DvcParserError
from dvc.cli.parser import get_main_parser
from pages import PAGES, ROOT, blocks, prose, spans

from physpipe import cli

PARAMS = yaml.safe_load((ROOT / "params.yaml").read_text())
MAKEFILE = (ROOT / "Makefile").read_text()
OURS = ("physpipe", "dvc", "make", "python")
PROGRAMS = (*OURS, "pip", "source", "git", "cd", "rm")
EXAMPLES = {"marbles", "dish", "coasting", "saturation"}
"""Names on the pages of what a reader would add."""
ASSIGNMENT = re.compile(r"[A-Z_]+=\S*")


def commands(page: Path) -> Iterator[str]:
    """Those of its `sh` blocks, and those of ours among its code spans."""
    for block in blocks(page, "sh"):
        yield from (part for line in block.text.splitlines() if line.strip() for part in line.split(" && "))
    yield from (span for span in spans(page) if " " in span and span.split()[0] in OURS and "…" not in span)


SHOWN = [pytest.param(command, id=f"{page.stem}: {command}") for page in PAGES for command in commands(page)]


@pytest.mark.parametrize("command", SHOWN)
def test_a_shown_command_is_understood(command):
    words = ["csv" if word == "FORMAT" else word for word in shlex.split(command, comments=True)]
    while ASSIGNMENT.fullmatch(words[0]):
        assert words.pop(0).split("=")[0] in sources()
    assert words[0] in PROGRAMS, words[0]
    check = {"physpipe": of_physpipe, "dvc": of_dvc, "make": of_make, "python": of_python}.get(words[0])
    if check:
        check(words[1:])


def of_physpipe(words: list[str]) -> None:
    understood(cli._parser(), words)


def of_dvc(words: list[str]) -> None:
    """DVC's own parser takes it, every key exists, and so does every stage."""
    asked = understood(get_main_parser(), words)
    for override in getattr(asked, "set_param", None) or []:
        key, _, value = override.partition("=")
        node = PARAMS
        for part in key.split("."):
            assert part in node or part in EXAMPLES, f"no key {key}"
            node = node.get(part, {})
        if key == "run.learned":
            assert set(value.strip("[]").split(",")) <= {*PARAMS["predictors"], *EXAMPLES}
        elif key in ("run.datasets", "run.simulated", "run.supervised"):
            assert set(filter(None, value.strip("[]").split(","))) <= {*PARAMS["datasets"], *EXAMPLES}
    if words[0] == "repro" or words[:2] == ["exp", "run"]:
        stages = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
        for target in getattr(asked, "targets", []):
            assert target.partition("@")[0] in stages, target


def of_make(words: list[str]) -> None:
    for word in words:
        name = word.split("=")[0]
        assert re.search(
            rf"^{name} \?=" if "=" in word else rf"^([\w ]+ )?{name}( [\w ]+)?:", MAKEFILE, re.MULTILINE
        ), word


def of_python(words: list[str]) -> None:
    if words[0] == "-m":
        assert "<" in words[1] or importlib.util.find_spec(words[1]), words[1]
    else:
        assert (ROOT / words[0]).is_file(), words[0]


def understood(parser: ArgumentParser, words: list[str]) -> Namespace:
    """What the parser makes of the words, nothing where they only name a command; fails where it refuses them."""
    said = StringIO()
    names_a_command = all(re.fullmatch("[a-z]+", word) for word in words)
    for tried in [words, [*words, "--help"]][: 1 + names_a_command]:
        try:
            with redirect_stderr(said), redirect_stdout(said):
                return parser.parse_args(tried)
        except (SystemExit, DvcParserError) as ended:
            if getattr(ended, "code", 1) == 0:  # help was asked for, and there is some
                return Namespace()
    raise AssertionError(f"{words}: {said.getvalue()}")


def sources() -> str:
    return MAKEFILE + "".join(path.read_text() for path in (ROOT / "physpipe").rglob("*.py"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_file_setting_and_link_that_a_page_names_is_there(page):
    for name in re.findall(r"\bPHYSPIPE_\w+", page.read_text(encoding="utf-8")):
        assert name in sources(), name
    for link in re.findall(r"\]\(([^)]+)\)", prose(page)):
        path, _, anchor = link.partition("#")
        if link.startswith("http"):
            continue
        target = (page.parent / path) if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


def anchors(page: Path) -> set[str]:
    """Those that Git hosts give to a page's headings."""
    heads = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def reachable(node: object, name: str) -> bool:
    """Whether the dotted `name` leads somewhere from `node`; `<set>` and names that a reader adds stand for any key."""
    key, _, rest = name.partition(".")
    inner = node if isinstance(node, dict) else {}
    nodes = list(inner.values()) if key.startswith("<") or key in EXAMPLES else [inner[key]] if key in inner else []
    return any(not rest or reachable(each, rest) for each in nodes)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_param_that_a_page_names_exists(page):
    """Spans such as `compute.threads`, or `ingest.clip_frames` for what is a data set's."""
    starts = [PARAMS, *PARAMS["datasets"].values()]
    roots = {key for start in starts for key in start}
    named = [re.match(r"[a-z_]+(\.[a-z_<>]+)+(?=$|:)", span) for span in spans(page)]
    for name in {each[0] for each in named if each and each[0].split(".")[0] in roots}:
        if name.endswith((".json", ".csv")):
            continue
        assert any(reachable(start, name) for start in starts), name
