"""A check-up prints everything, and its exit code says whether something is in the way."""

import pytest

from physpipe.commands import doctor
from physpipe.health import machine, pipeline, project
from physpipe.health.finding import Finding


@pytest.fixture
def healthy(monkeypatch):
    monkeypatch.setattr(machine, "check", lambda: [Finding("ok", "a machine")])
    monkeypatch.setattr(project, "check", lambda ask: [Finding("warning", "a project", "mend it")])
    monkeypatch.setattr(pipeline, "check", lambda ask: [Finding("runs", "cut@a: code")])


def test_warnings_are_no_problem(healthy, run):
    printed = run("doctor")
    assert "warning  a project\n         to mend: mend it" in printed
    assert "0 problems, 1 warning, 1 kind of stages would run" in printed


def test_a_problem_ends_with_1(healthy, run, monkeypatch, capsys):
    monkeypatch.setattr(machine, "check", lambda: [Finding("problem", "no disk", "buy one")])
    with pytest.raises(SystemExit) as ended:
        run("doctor")
    assert ended.value.code == 1
    assert "a project" in capsys.readouterr().out  # the rest is looked at all the same


def test_a_library_that_cannot_be_loaded_is_a_problem_not_a_crash(healthy, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "physpipe.health.project", None)
    monkeypatch.delattr("physpipe.health.project")
    last = list(doctor._findings())[-1]
    assert last.level == "problem"
    assert "make setup" in last.mend
