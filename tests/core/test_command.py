"""A stage's `main` as a command line."""

from pathlib import Path

import pytest

from physpipe.core.command import run
from physpipe.core.errors import InputError


def test_words_become_paths_where_main_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    got: list[object] = []

    def main(name: str, clips: Path, out: Path) -> None:
        got.extend([name, clips, out])

    monkeypatch.setattr("sys.argv", ["stage", "bowls", "data/clips", "out.parquet"])
    run(main)
    assert got == ["bowls", Path("data/clips"), Path("out.parquet")]


def test_another_number_of_words_ends_with_the_names_of_those_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    def main(name: str, clips: Path) -> None:
        raise AssertionError

    monkeypatch.setattr("sys.argv", ["stage", "bowls"])
    with pytest.raises(SystemExit, match="takes name, clips; got 1 words"):
        run(main)


def test_a_users_mistake_ends_as_one_line_but_ours_as_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def mistaken(clips: Path) -> None:
        raise InputError(clips, "no such file", "make it")

    def broken(clips: Path) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("sys.argv", ["stage", "clips"])
    with pytest.raises(SystemExit, match=r"^error: clips: no such file. To mend: make it.$"):
        run(mistaken)
    with pytest.raises(ZeroDivisionError):
        run(broken)
