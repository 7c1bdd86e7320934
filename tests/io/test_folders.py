"""Recordings in folders of every shape, and what they are called."""

from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.io import folders


def laid(folder: Path, *names: str) -> Path:
    """The folder with a file of one byte under each of the names."""
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(b"x")
    return folder


def listed(folder: Path) -> list[str]:
    return [folders.source(path, folder) for path in folders.recordings(folder)]


def test_a_folder_lists_recordings_and_leaves_their_companions(tmp_path: Path) -> None:
    laid(tmp_path, "b.MP4", "a.webm", "a.ref.csv", "LICENSE", "README.md", ".hidden.mp4", "c/1.png")
    (tmp_path / "empty").mkdir()
    assert listed(tmp_path) == ["a.webm", "b.MP4", "c"]


def test_recordings_are_found_at_any_depth_and_tables_beside_them_are_none(tmp_path: Path) -> None:
    film = ["PoolR/test/1.mp4", "PoolR/train/1.mp4", "PoolR/train/burst/1.png", "PoolR/train/burst/2.png", "z.avi"]
    notes = ["splits.csv", "PoolR/meta.json", "PoolR/train/list.txt", "PoolR/train/1.npz", ".cache/x.mp4", "docs/a.txt"]
    laid(tmp_path, *film, *notes)
    assert listed(tmp_path) == ["PoolR/test/1.mp4", "PoolR/train/1.mp4", "PoolR/train/burst", "z.avi"]


def test_only_a_videos_name_loses_its_suffix(tmp_path: Path) -> None:
    laid(tmp_path, "in/ball.v2.mp4", "in/burst.v2/1.png")
    stems = [folders.stem(path, tmp_path) for path in folders.recordings(tmp_path)]
    assert stems == ["in/ball.v2", "in/burst.v2"]


def test_folders_without_recordings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        folders.recordings(tmp_path / "absent")
    with pytest.raises(InputError, match="holds no recording"):
        folders.recordings(laid(tmp_path, "notes/a.txt"))


@pytest.mark.parametrize(
    "names", [["1.png"], ["in/1.png", "in/a.mp4"], ["in/1.png", "in/burst/1.png"], ["1.png", "a.mp4"]]
)
def test_images_beside_recordings_are_refused(tmp_path: Path, names: list[str]) -> None:
    with pytest.raises(InputError, match="a lone image") as caught:
        folders.recordings(laid(tmp_path, *names))
    assert caught.value.where == str(tmp_path / names[0])


def test_linked_folders_count_but_never_go_round(tmp_path: Path) -> None:
    laid(tmp_path, "elsewhere/a.mp4", "set/in/b.mp4")
    (tmp_path / "set" / "linked").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "set" / "in" / "round").symlink_to(tmp_path / "set")
    assert listed(tmp_path / "set") == ["in/b.mp4", "linked/a.mp4"]
