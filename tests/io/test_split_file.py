"""`splits.csv`: what it decides, and every mistake named at once."""

from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.io import folders, split_file
from physpipe.io.clips import Split

FILM = ["PoolR/test/1.mp4", "PoolR/train/1.mp4", "PoolR/train/2.v2.mp4", "burst/1.png"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A set of three videos in two folders, and a folder of images."""
    for name in FILM:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    return tmp_path


def read(folder: Path, *lines: str) -> dict[str, Split] | None:
    (folder / "splits.csv").write_text("\n".join(["recording,split", *lines]))
    return split_file.read(folder, folders.recordings(folder))


def refusal(folder: Path, *lines: str) -> InputError:
    with pytest.raises(InputError) as caught:
        read(folder, *lines)
    assert caught.value.where == str(folder / "splits.csv")
    return caught.value


def test_without_a_file_nothing_is_decided(folder: Path) -> None:
    assert split_file.read(folder, folders.recordings(folder)) is None


def test_recordings_go_by_their_path_with_or_without_suffix(folder: Path) -> None:
    lines = ["PoolR/test/1.mp4,test", "./PoolR/train/1, train", "", "PoolR\\train\\2.v2,valid", "burst/,train"]
    assert read(folder, *lines, "PoolR/test/1,test") == {
        "PoolR/test/1.mp4": "test",
        "PoolR/train/1.mp4": "train",
        "PoolR/train/2.v2.mp4": "valid",
        "burst": "train",
    }


def test_every_bad_line_is_named_at_once(folder: Path) -> None:
    error = refusal(
        folder,
        "PoolR/test/1.mp4,test",
        "PoolR/train/3.mp4,train",  # line 3
        "1.mp4,test",  # a name alone could be either video's
        "PoolR/train/1.mp4,training",
        "PoolR/test/1,train",  # line 6: the recording of line 2
        "nowhere.mp4,never",
        ",train",
        "burst,valid",
        "burst,training",
        "burst,test",  # line 11: the recording of line 9
    )
    assert error.reason.strip().splitlines() == [
        "line 3: no recording `PoolR/train/3.mp4`",
        "  line 4: no recording `1.mp4`",
        "  line 5: no split `training`",
        "  line 6: `PoolR/test/1` is `test` in line 2 and `train` here",
        "  line 7: no recording `nowhere.mp4`",
        "  line 7: no split `never`",
        "  line 8: no recording ``",
        "  line 10: no split `training`",
        "  line 11: `burst` is `valid` in line 9 and `test` here",
        "  no line for the recording `PoolR/train/2.v2.mp4`",
    ]
    assert "its path inside" in error.mend
    assert "one of train, valid, test" in error.mend


def test_no_recording_is_left_to_chance(folder: Path) -> None:
    lines = ["PoolR/test/1,test", "PoolR/train/1,train", "PoolR/train/2.v2,valid"]
    assert refusal(folder, *lines).reason.strip() == "no line for the recording `burst`"
    assert refusal(folder).reason.count("no line for the recording") == 4


def test_a_file_without_its_columns_is_refused(folder: Path) -> None:
    (folder / "splits.csv").write_text("PoolR/test/1.mp4,test\n")
    with pytest.raises(InputError, match="begin it with recording,split"):
        split_file.read(folder, folders.recordings(folder))
