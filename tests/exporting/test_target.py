"""An export appears whole, over nothing but an earlier export."""

from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.exporting.target import exported, writable


def export(folder: Path, name: str) -> None:
    with exported(folder, {"set": name}) as inside:
        (inside / f"{name}.txt").write_text(name)


def test_an_earlier_export_is_replaced(tmp_path: Path) -> None:
    export(tmp_path / "out", "old")
    export(tmp_path / "out", "new")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["about.json", "new.txt"]


def test_an_empty_folder_may_be_there(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    export(tmp_path / "out", "new")
    assert (tmp_path / "out" / "new.txt").is_file()


def test_other_files_are_never_replaced(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match="holds other files"):
        export(tmp_path, "new")
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_what_fails_leaves_the_earlier_export(tmp_path: Path) -> None:
    export(tmp_path / "out", "old")
    with pytest.raises(RuntimeError), exported(tmp_path / "out", {}):
        raise RuntimeError
    assert (tmp_path / "out" / "old.txt").is_file()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("below", ["out", "deep/out"])
def test_a_place_that_cannot_be_written_is_named(tmp_path: Path, below: str) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(InputError, match="cannot be written") as caught:
        export(tmp_path / "file" / below, "new")
    assert caught.value.where == str(tmp_path / "file" / below)


def test_other_errors_stay_what_they_are(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), writable(tmp_path / "a" / "out"):
        (tmp_path / "elsewhere" / "absent").read_text()
