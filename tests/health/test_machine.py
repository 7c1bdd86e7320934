"""A sound machine has no problem; what is missing, doubled or full is one."""

import sys
from collections import namedtuple

import pytest

from physpipe.health import machine


def levels(findings) -> set[str]:
    return {each.level for each in findings}


def test_this_machine_can_run_the_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    plenty = namedtuple("Usage", "free")(10**12)
    monkeypatch.setattr("shutil.disk_usage", lambda path: plenty)
    monkeypatch.setattr("os.getloadavg", lambda: (0.0, 0.0, 0.0), raising=False)
    found = list(machine.check())
    assert [each for each in found if each.level == "problem"] == []
    text = "\n".join(each.text for each in found)
    for said in ("Python 3.", "torch ", "FFmpeg", "libavcodec", "GPU", "cores", "GB free"):
        assert said in text


def test_two_opencvs_and_missing_libraries_are_problems(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "_version", lambda name: None if name == "mujoco" else "1.0")
    problems = [each for each in machine._libraries() if each.level == "problem"]
    assert "mujoco" in problems[0].text
    assert "they overwrite each other" in problems[1].text
    assert "pip uninstall opencv-python" in problems[1].mend


@pytest.mark.parametrize(("free_gb", "level"), [(100, "ok"), (3, "warning"), (0.5, "problem")])
def test_a_full_disk_is_told_in_time(monkeypatch: pytest.MonkeyPatch, free_gb: float, level: str) -> None:
    usage = namedtuple("Usage", "free")(free_gb * 1e9)
    monkeypatch.setattr("shutil.disk_usage", lambda path: usage)
    assert levels(machine._disks()) == {level}


def test_a_busy_machine_is_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.getloadavg", lambda: (1000.0, 0.0, 0.0), raising=False)
    assert machine._cores().level == "warning"


def test_an_old_python_is_a_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.version_info", (3, 9, 0))
    assert machine._python().level == "problem"


def test_a_torch_that_cannot_be_imported_is_a_problem_not_a_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    (found,) = machine._torch()
    assert found.level == "problem"
    assert "make setup" in found.mend
