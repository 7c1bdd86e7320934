"""What would run, and why, from what DVC says; and once from DVC itself."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.health import pipeline
from physpipe.health.asking import ask
from physpipe.health.finding import Finding, lines

LOCK = """\
stages:
  cut:
    outs: [{path: data/clips}]
  learn@a:
    deps: [{path: data/clips/a}]
    outs: [{path: data/nets/a}]
  page:
    deps: [{path: data/nets}, {path: physpipe/report}]
    outs: [{path: report}]
  other:
    deps: [{path: data/clipsy}]
    outs: [{path: data/x}]
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dvc.lock").write_text(LOCK)
    return tmp_path


def answering(status: dict[str, object]) -> Callable[..., str]:
    return lambda *words: "3.0" if "--version" in words else json.dumps(status)


def said(status: dict[str, object]) -> list[Finding]:
    return list(pipeline.check(answering(status)))


def test_nothing_to_do_is_said_so() -> None:
    assert said({})[-1] == Finding("ok", "all stages are up to date: nothing would run")


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        (
            [{"changed deps": {"physpipe/io": "modified", "stages/cut.py": "modified"}}],
            "code physpipe/io, stages/cut.py",
        ),
        ([{"changed deps": {"params.yaml": {"tracker.lock": "modified", "run": "new"}}}], "numbers tracker.lock, run"),
        ([{"changed deps": {"data/raw/x": "modified"}}], "other input data/raw/x"),
        ([{"changed outs": {"data/nets/x": "not in cache"}}], "no data/nets/x"),
        ([{"changed outs": {"data/nets/x": "modified"}}], "changed by hand data/nets/x"),
        ([{"changed deps": {"data/clips/a": "deleted"}}], "its inputs are missing"),
        ([{"changed deps": {"data/raw/x": "deleted"}}], "no data/raw/x"),
        (["changed command"], "changed command"),
        ([{"changed deps": {f"physpipe/{n}": "modified" for n in range(8)}}], "physpipe/5 and 2 more"),
    ],
)
def test_the_reason_is_in_words(changes: list[object], why: str) -> None:
    assert why in pipeline.reason(changes, ["data/clips/a", "data/nets"])


def test_sets_of_which_the_same_holds_stand_together_and_what_follows_is_named() -> None:
    changed = [{"changed outs": {"data/nets/a": "deleted"}}]
    found = said({"learn@a": changed, "learn@b": [{"changed outs": {"data/nets/b": "deleted"}}], "other": ["x"]})
    runs = [each.text for each in found if each.level == "runs"]
    assert runs == [
        "learn@a, b: no data/nets/*",
        "other: x",
        "and, if what they read comes out otherwise: page",
    ]


def test_following_goes_on_through_folders_and_parts_of_them() -> None:
    locked = pipeline._locked()
    assert pipeline.following({"cut": []}, locked) == ["learn@a", "page"]
    assert pipeline.following({"page": []}, locked) == []


def test_film_that_changed_is_the_user_s_to_decide() -> None:
    found = said({"data/raw/a.dvc": [{"changed outs": {"data/raw/a": "modified"}}]})
    assert (found[1].level, "dvc add data/raw/a" in found[1].mend) == ("warning", True)


def test_a_lock_left_by_a_kill_is_a_problem(here: Path) -> None:
    (here / ".dvc" / "tmp").mkdir(parents=True)
    (here / ".dvc" / "tmp" / "rwlock").touch()
    assert [each.level for each in said({})] == ["ok", "problem", "ok"]


def test_dvc_that_fails_is_a_problem_with_a_mend() -> None:
    def fails(*words: str) -> str:
        raise InputError("dvc status", "failed (no repository)", "run it by hand")

    assert list(pipeline.check(fails)) == [Finding("problem", "dvc status: failed (no repository)", "run it by hand")]


def test_programs_are_found_beside_python_and_named_when_they_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", os.devnull)
    assert ask("dvc", "--version").strip()[0].isdigit()
    with pytest.raises(InputError, match="dvc status: failed"):
        ask("dvc", "status")
    monkeypatch.setattr(sys, "executable", str(Path("nowhere") / "python"))
    with pytest.raises(InputError, match=r"dvc: not found.*pip install"):
        ask("dvc", "--version")


def test_dvc_itself_says_what_would_run(here: Path) -> None:
    (here / "dvc.lock").unlink()
    (here / "in.txt").write_text("1")
    stage = "python -c \"open('out.txt', 'w').write(open('in.txt').read())\""
    (here / "dvc.yaml").write_text(f"stages:\n  copy:\n    cmd: {stage}\n    deps: [in.txt]\n    outs: [out.txt]\n")
    quiet = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    for command in ("dvc init --no-scm -q", "dvc repro -q"):
        subprocess.run(command.split(), check=True, env=quiet, capture_output=True)
    assert list(pipeline.check(ask))[-1].text == "all stages are up to date: nothing would run"
    (here / "in.txt").write_text("2")
    assert list(pipeline.check(ask))[-1] == Finding("runs", "copy: other input in.txt")


def test_a_finding_is_printed_with_its_mend() -> None:
    assert lines(Finding("ok", "fine")) == ["ok       fine"]
    assert lines(Finding("problem", "bad", "do that"))[1].strip() == "to mend: do that"
