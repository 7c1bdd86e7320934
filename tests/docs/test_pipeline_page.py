"""docs/pipeline.md says what dvc.yaml does: its pictures have the same edges, its table the same words."""

import re
from itertools import pairwise

import pytest
import yaml
from pages import ROOT, blocks, prose

PAGE = ROOT / "docs/pipeline.md"
WRITTEN = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
STAGES = {name: each.get("do", each) for name, each in WRITTEN.items()}
CODE = ("stages/", "physpipe/")
EVERYWHERE = {"physpipe/core", "physpipe/io"}
TRUTH = {"data/annotations", "data/truth", "data/baselines", "data/scores"}
NODE = re.compile(r"(\w+)\[\((.+?)\)\]")
ARROW = re.compile(r"\s*(?:-->|-\.->)\s*")


def paths(entries: list) -> list[str]:
    return [next(iter(each)) if isinstance(each, dict) else each for each in entries]


def folder(path: str) -> str:
    """`data/<folder>`, or the first folder of another path."""
    parts = path.split("/")
    return "/".join(parts[: 2 if parts[0] == "data" else 1])


def edges_of_dvc() -> set[tuple[str, str]]:
    """From a folder to the stages that read it, and from a stage to the folders that it writes into."""
    read = {(folder(dep), name) for name, each in STAGES.items() for dep in each["deps"] if not dep.startswith(CODE)}
    return read | {(name, folder(out)) for name, each in STAGES.items() for out in paths(each["outs"])}


def pictures() -> list[str]:
    return [block.text for block in blocks(PAGE, "mermaid")]


def edges_of(picture: str) -> set[tuple[str, str]]:
    """The picture's arrows, folders by their paths."""
    folders = dict(NODE.findall(picture))
    found = set()
    for line in NODE.sub(r"\1", picture).splitlines():
        groups = [[each.strip() for each in group.split("&")] for group in ARROW.split(line.strip())]
        for before, after in pairwise(groups):
            found |= {(folders.get(one, one), folders.get(two, two)) for one in before for two in after}
    return found


def test_the_arrows_of_the_pictures_are_those_of_dvc_yaml():
    drawn, true = set().union(*map(edges_of, pictures())), edges_of_dvc()
    assert (sorted(drawn - true), sorted(true - drawn)) == ([], []), "(drawn but not there, there but not drawn)"


def test_stages_that_read_truth_are_coloured_and_no_others():
    readers = {name for name, each in STAGES.items() if TRUTH & {folder(dep) for dep in each["deps"]}}
    coloured = {
        name
        for picture in pictures()
        for names in re.findall(r"class (\S+) truth", picture)
        for name in names.split(",")
    }
    assert coloured == readers


def test_dotted_stages_are_those_that_run_only_when_asked_for():
    over = {name: str(each.get("foreach", each.get("matrix"))) for name, each in WRITTEN.items()}
    optional = {name for name, names in over.items() if "run.flow" in names or "run.finetuned" in names}
    dotted = {line for picture in pictures() for line in picture.splitlines() if "-.->" in line}
    plain = "\n".join(line for picture in pictures() for line in picture.splitlines() if "-->" in line)
    assert all(any(name in line for line in dotted) for name in optional)
    assert not any(name in plain for name in optional)


def row(name: str) -> str:
    """What the table must say of a stage."""
    stage = STAGES[name]
    code = [
        f"`{dep.removeprefix('physpipe/')}`"
        for dep in stage["deps"]
        if dep.startswith("physpipe/") and dep not in EVERYWHERE
    ]
    params = [
        re.sub(r"\$\{item(?:\.(\w+))?\}", lambda each: f"<{each[1] or 'item'}>", word) for word in stage["params"]
    ]
    once = {"simulate": "<set>", "train_flow": "<flow>"}.get(name, "<set>")
    named = [f"`{word.replace('<item>', once).replace('<dataset>', '<set>')}`" for word in params]
    return f"| `{name}` | {stage['desc']} | {', '.join(code) or '–'} | {', '.join(named)} |"


@pytest.mark.parametrize("name", STAGES)
def test_the_table_says_of_every_stage_what_dvc_yaml_says(name):
    (found,) = [line for line in prose(PAGE).splitlines() if line.startswith(f"| `{name}` |")]
    assert found == row(name)


def test_the_table_has_the_stages_of_dvc_yaml_in_their_order_and_no_other():
    named = re.findall(r"^\| `(\w+)` \|", prose(PAGE), re.MULTILINE)
    assert named == list(STAGES)
