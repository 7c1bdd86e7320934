"""The shipped project is sound; what is wrong in a copy is named with its mend."""

import shutil
from pathlib import Path

import pytest
import yaml

from physpipe.core.errors import InputError
from physpipe.health import project

ROOT = Path(__file__).parents[2]


@pytest.fixture
def params(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copy(ROOT / "params.yaml", tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "params.yaml"


def on_main(*words: str) -> str:
    return "main\n"


def change(params: Path, **values: object) -> None:
    tree = yaml.safe_load(params.read_text())
    for key, value in values.items():
        section, name = key.split("__")
        tree[section][name] = value
    params.write_text(yaml.safe_dump(tree))


def problems(ask=on_main) -> list[str]:
    return [f"{each.text}; {each.mend}" for each in project.check(ask) if each.level == "problem"]


def test_the_shipped_params_are_sound(params: Path) -> None:
    assert problems() == []


def test_elsewhere_the_root_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "run from the project's root" in problems()[0]


def test_film_that_is_not_there_is_a_problem(params: Path) -> None:
    change(params, run__datasets=["pendulum"], run__simulated=[])
    (said,) = problems()
    assert "film of pendulum" in said
    assert "physpipe add pendulum FOLDER" in said


def test_a_slip_in_params_is_named(params: Path) -> None:
    change(params, compute__threads=0)
    assert "compute.threads" in problems()[0]
    change(params, run__datasets=["bowlz"])
    assert any("bowlz" in each or "compute" in each for each in problems())


def test_more_threads_than_cores_are_warned_of(params: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    change(params, compute__threads=4)
    assert any("compute.threads" in each.text for each in project.check(on_main) if each.level == "warning")


def test_a_lost_branch_and_no_git_are_warned_of(params: Path) -> None:
    def no_git(*words: str) -> str:
        raise InputError("git", "not found", "install it")

    for ask, said in ((lambda *words: "HEAD\n", "on no branch"), (no_git, "git: not found")):
        assert said in [each.text for each in project.check(ask) if each.level == "warning"][-1]


def test_a_git_that_does_not_know_its_user_is_warned_of(params: Path) -> None:
    def nameless(*words: str) -> str:
        if "user.name" in words:
            raise InputError(" ".join(words), "failed (no word)", "run it by hand")
        return "main\n"

    (said,) = [each for each in project.check(nameless) if "user." in each.text]
    assert (said.level, said.mend) == ("warning", "`git config --global user.name ...`")
