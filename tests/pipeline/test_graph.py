"""What dvc.yaml promises, read from dvc.yaml itself: every import covered, every param named, truth out of reach."""

import ast
import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
STAGES = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
TRUTH = ("data/annotations", "data/truth", "data/baselines", "data/scores", "metrics", "report")
LEFT_OUT = ("size", "nfiles")
"""Keys that DVC's run cache compares of no file, and so of no section of params either."""
MAY_READ_TRUTH = {
    "ground_truth",
    "baseline_tracks",
    "flow_tracks",
    "evaluate_trackers",
    "evaluate_finetuned",
    "evaluate_predictors",
    "train_supervised",
    "forecast_supervised",
    "supervised_baseline_forecasts",
    "report",
}


def body(name: str) -> dict:
    """A stage as written, whether under `foreach` or not."""
    return STAGES[name].get("do", STAGES[name])


def paths(entries: list) -> list[str]:
    """Paths of `deps` or `outs`, with the data set's name left open."""
    plain = [next(iter(each)) if isinstance(each, dict) else each for each in entries]
    return [re.sub(r"\$\{item(\.\w+)?\}", "*", each) for each in plain]


def module_file(module: str) -> Path | None:
    """The project's file of a dotted module name, if it is the project's."""
    path = ROOT / module.replace(".", "/")
    if path.with_suffix(".py").is_file():
        return path.with_suffix(".py")
    return path / "__init__.py" if (path / "__init__.py").is_file() else None


def imported(file: Path) -> set[Path]:
    """Files of the project that `file` imports, wherever in it the import stands."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names = [each.name for each in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module, *(f"{node.module}.{each.name}" for each in node.names)]
        else:
            continue
        found |= {path for name in names if (path := module_file(name))}
    return found


def closure(file: Path) -> set[Path]:
    """Everything that `file` needs to run."""
    known, new = {file}, {file}
    while new:
        new = {each for file in new for each in imported(file)} - known
        known |= new
    return known


def entry(name: str) -> Path:
    """The stage's own file."""
    return ROOT / "stages" / (re.search(r"python -m stages\.(\w+)", body(name)["cmd"])[1] + ".py")


@pytest.mark.parametrize("name", STAGES)
def test_every_import_of_a_stage_is_among_its_deps_and_every_code_dep_is_imported(name):
    deps = [ROOT / each for each in paths(body(name)["deps"]) if not each.startswith(("data/", "metrics/"))]
    package_roots = {ROOT / "physpipe/__init__.py", ROOT / "stages/__init__.py"}  # a docstring each
    needed = closure(entry(name)) - package_roots
    uncovered = [file for file in needed if not any(file.is_relative_to(dep) for dep in deps)]
    idle = [dep for dep in deps if not any(file.is_relative_to(dep) for file in needed)]
    assert (uncovered, idle) == ([], [])


def test_package_roots_import_nothing():
    for package in ("physpipe", "stages"):
        assert imported(ROOT / package / "__init__.py") == set()


def sections_read(name: str) -> set[str]:
    """Sections that the stage's file asks for, with names that it is given left open."""
    found = set()
    for node in ast.walk(ast.parse(entry(name).read_text())):
        called = isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", ""))
        if called in ("read", "read_value"):
            section = node.args[0]
            parts = section.values if isinstance(section, ast.JoinedStr) else [section]
            found.add("".join(each.value if isinstance(each, ast.Constant) else "*" for each in parts))
    return found


@pytest.mark.parametrize("name", STAGES)
def test_every_section_that_a_stage_reads_is_among_its_params_and_every_param_is_read(name):
    named = set(paths(body(name).get("params", [])))
    read = sections_read(name)
    within = lambda inner, outer: inner == outer or inner.startswith(outer + ".")  # noqa: E731
    assert [each for each in read if not any(within(each, param) for param in named)] == []
    whole = {param for param in named if param.rsplit(".", 1)[-1] not in LEFT_OUT}
    assert [param for param in whole if not any(within(each, param) for each in read)] == []
    assert [param for param in named - whole if not any(within(param, each) for each in read)] == []


def keys_below(section: object) -> set[str]:
    """Dotted names of all keys within a section."""
    if not isinstance(section, dict):
        return set()
    return set(section) | {f"{key}.{below}" for key, each in section.items() for below in keys_below(each)}


def sections(params: dict, named: str) -> list[object]:
    """What stands in params.yaml under a dotted name, whatever `*` in it stands for."""
    found = [params]
    for key in named.split("."):
        inside = [each for each in found if isinstance(each, dict)]
        found = [each[k] for each in inside for k in (each if key == "*" else [key]) if k in each]
    return found


@pytest.mark.parametrize("name", [each for each in STAGES if each != "evaluate_predictors"])
def test_params_that_the_run_cache_leaves_out_within_a_section_are_named_by_themselves(name):
    """The clips that are evaluated are of that size, so they tell."""
    params = yaml.safe_load((ROOT / "params.yaml").read_text())
    named = set(paths(body(name).get("params", [])))
    below = {f"{each}.{key}" for each in named for found in sections(params, each) for key in keys_below(found)}
    assert {key for key in below if key.rsplit(".", 1)[1] in LEFT_OUT} <= named


def test_no_number_or_default_path_hides_in_a_command():
    for name in STAGES:
        words = body(name)["cmd"].split()
        assert words[:2] == ["python", "-m"]
        assert all(re.fullmatch(r"[\w./${}-]+", each) and not each.startswith("-") for each in words[3:]), name


def test_only_the_stages_named_so_can_reach_truth():
    makers = {out: name for name in STAGES for out in paths(body(name)["outs"])}
    for name in set(STAGES) - MAY_READ_TRUTH:
        deps = paths(body(name)["deps"])
        assert not [each for each in deps if each.startswith(TRUTH)], name
        upstream = {
            maker for dep in deps for out, maker in makers.items() if out.startswith(dep) or dep.startswith(out)
        }
        assert not upstream & MAY_READ_TRUTH, name
        words = body(name)["cmd"].split()[3:]
        outs = [next(iter(each)) if isinstance(each, dict) else each for each in body(name)["outs"]]
        read = [each for each in words if each.startswith(TRUTH) and each not in outs]
        assert read == [], f"{name} is handed truth on its command line"


def test_every_path_of_a_command_is_a_dep_or_an_out():
    for name in STAGES:
        stage = body(name)
        known = paths(stage["deps"]) + paths(stage["outs"])
        for word in paths([each for each in stage["cmd"].split()[3:] if "/" in each]):
            assert any(each == word or each.startswith(word + "/") or word.startswith(each + "/") for each in known), (
                name,
                word,
            )


def test_every_stage_says_what_it_does():
    assert [name for name in STAGES if not body(name).get("desc")] == []


def test_the_page_is_never_a_link_into_the_cache():
    assert {"report": {"cache": False}} in body("report")["outs"]  # browsers show a file without suffix as text


def test_git_ignores_all_that_dvc_keeps():
    ignored = (ROOT / ".gitignore").read_text().splitlines()
    kept = {out for name in STAGES for out in paths([each for each in body(name)["outs"] if isinstance(each, str)])}
    roots = {"/".join(out.split("/")[:2]) for out in kept} - {"data/raw", "data/annotations"}  # users add to those
    assert [root for root in sorted(roots) if f"/{root}/" not in ignored] == []
