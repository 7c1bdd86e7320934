"""An export appears whole, over nothing but an earlier export."""

import json
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


def test_another_program_s_about_json_makes_no_export(tmp_path: Path) -> None:
    mine = {"thesis.tex": "years of work", "about.json": '{"title": "Thesis", "files": ["thesis.tex"]}'}
    for text in (mine["about.json"], "[1, 2]", "no JSON", '{"written_by": "physpipe"}'):
        files = mine | {"about.json": text}
        for name, content in files.items():
            (tmp_path / name).write_text(content)
        with pytest.raises(InputError, match=r"holds other files, and no about\.json of an export"):
            export(tmp_path, "new")
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == files


@pytest.mark.parametrize("name", ["notes.md", "old.txt/notes.md", "deep/er/notes.md", ".hidden"])
def test_what_was_put_into_an_export_stays(tmp_path: Path, name: str) -> None:
    with exported(tmp_path / "out", {}) as inside:
        (inside / "old.txt").mkdir()
        (inside / "old.txt" / "a.csv").write_text("a")
    note = tmp_path / "out" / name
    note.parent.mkdir(parents=True, exist_ok=True)
    note.write_text("mine")
    with pytest.raises(InputError, match=f"not of the earlier export: {name}") as caught:
        export(tmp_path / "out", "new")
    assert "--out" in caught.value.mend
    assert (note.read_text(), (tmp_path / "out" / "old.txt" / "a.csv").read_text()) == ("mine", "a")


def test_links_are_not_ours_wherever_they_lead(tmp_path: Path) -> None:
    export(tmp_path / "out", "old")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out" / "linked").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="linked"):
        export(tmp_path / "out", "new")


def test_what_comes_while_an_export_is_written_stays_too(tmp_path: Path) -> None:
    export(tmp_path / "out", "old")
    with pytest.raises(InputError, match="notes"), exported(tmp_path / "out", {}):
        (tmp_path / "out" / "notes.md").write_text("mine")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["about.json", "notes.md", "old.txt"]


def test_an_export_lists_its_files_and_misses_none_that_are_gone(tmp_path: Path) -> None:
    with exported(tmp_path / "out", {"set": "balls"}) as inside:
        (inside / "b").mkdir()
        (inside / "b" / "c.ini").write_text("c")
        (inside / "a.txt").write_text("a")
    about = json.loads((tmp_path / "out" / "about.json").read_text())
    assert about == {"set": "balls", "written_by": "physpipe", "files": ["a.txt", "b/c.ini"]}
    (tmp_path / "out" / "a.txt").unlink()
    export(tmp_path / "out", "new")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["about.json", "new.txt"]


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
