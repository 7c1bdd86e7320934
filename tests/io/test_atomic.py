"""Files and folders appear whole or not at all."""

import errno
from pathlib import Path

import pytest

from physpipe.core.errors import DiskFullError, InputError
from physpipe.io.atomic import replacing, replacing_folder


def test_a_file_appears_when_the_block_ends_well(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "a.txt"
    with replacing(path) as temporary:
        temporary.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert list(path.parent.iterdir()) == [path]


def test_a_failed_block_keeps_the_older_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")

    def half_done() -> None:
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        half_done()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_replaces_the_older_one_as_a_whole(tmp_path: Path) -> None:
    for content in ("old", "new"):
        with replacing_folder(tmp_path / "set") as temporary:
            (temporary / content).touch()
    assert [path.name for path in (tmp_path / "set").iterdir()] == ["new"]


def test_a_failed_block_keeps_the_older_folder(tmp_path: Path) -> None:
    with replacing_folder(tmp_path / "set") as temporary:
        (temporary / "old").touch()

    def half_done() -> None:
        with replacing_folder(tmp_path / "set") as temporary:
            (temporary / "half").touch()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        half_done()
    assert [path.name for path in (tmp_path / "set").iterdir()] == ["old"]
    assert [path.name for path in tmp_path.iterdir()] == ["set"]


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "No space left on device"), OSError("4096 requested and 0 written")]
)
@pytest.mark.parametrize("replace", [replacing, replacing_folder])
def test_a_full_disk_is_named(tmp_path: Path, replace, error: OSError) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(DiskFullError) as caught, replace(tmp_path / "out"):
        raise error
    assert isinstance(caught.value, InputError)
    assert caught.value.where == str(tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_other_system_errors_stay_what_they_are(tmp_path: Path) -> None:
    with pytest.raises(PermissionError), replacing(tmp_path / "out"):
        raise PermissionError(errno.EACCES, "no")
