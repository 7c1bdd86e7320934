"""A folder of recordings to clips: names, splits, the store of converted recordings, and every way to fail."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from physpipe.core.errors import DiskFullError, InputError
from physpipe.ingest import dataset, recording
from physpipe.ingest.dataset import IngestParams, clip_name, ingest
from physpipe.io import clips
from physpipe.io.clips import Clip, ClipSet

Roll = Callable[..., NDArray[np.uint8]]
Film = Callable[..., Path]


@pytest.fixture(autouse=True)
def _alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_SCRATCH", str(tmp_path / "scratch"))
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")


@pytest.fixture
def raw(tmp_path: Path, roll: Roll, film: Film) -> Path:
    """Two recordings at 200 frames/s: 60 and 40 frames."""
    film(tmp_path / "raw" / "one.mkv", roll(count=60, seed=1), np.arange(60) / 200)
    film(tmp_path / "raw" / "two b.mkv", roll(count=40, seed=2, start=0), np.arange(40) / 200)
    return tmp_path / "raw"


@pytest.fixture
def conversions(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the recordings that get decoded from now on."""
    decoded: list[str] = []
    convert = recording.convert

    def noted(path: Path, folder: Path, params: recording.ConvertParams) -> None:
        decoded.append(path.name)
        convert(path, folder, params)

    monkeypatch.setattr(recording, "convert", noted)
    return decoded


def made(raw: Path, options: dict[str, Any], **changes: Any) -> list[Clip]:
    return list(ingest("set", raw, IngestParams(**{**options, **changes}))[0])


def refusal(raw: Path, options: dict[str, Any], **changes: Any) -> InputError:
    with pytest.raises(InputError) as caught:
        made(raw, options, **changes)
    return caught.value


def test_clips_carry_names_sources_times_and_geometry(raw: Path, ingest_params: Any) -> None:
    found = made(raw, ingest_params, fps=50.0, clip_frames=8)
    assert [clip.name for clip in found] == ["one_00", "one_01", "two-b_00"]
    assert [clip.source for clip in found] == ["one.mkv", "one.mkv", "two b.mkv"]
    assert [len(clip.frames) for clip in found] == [8, 7, 8]
    for clip in found:
        np.testing.assert_allclose(clip.times_s, np.arange(len(clip.frames)) / 50, atol=1e-9)
        assert clip.frames.shape[1:] == (32, 32, 3)
        assert clip.geometry.left == 16
    assert found[1].source_frames.tolist() == list(range(32, 60, 4))
    np.testing.assert_allclose(found[1].source_times_s, np.arange(32, 60, 4) / 200, atol=1e-9)


def test_the_recordings_table_has_a_row_for_each(raw: Path, ingest_params: Any) -> None:
    _, table = ingest("set", raw, IngestParams(**{**ingest_params, "fps": 50.0, "clip_frames": 8, "min_frames": 8}))
    assert list(table.columns) == dataset.RECORDINGS
    assert table["source"].tolist() == ["one.mkv", "two b.mkv"]
    assert table["measured_fps"].tolist() == pytest.approx([200, 200])
    assert table["frames"].tolist() == [60, 40]
    assert table["kept"].tolist() == [8, 8]
    assert table["dropped"].tolist() == [7, 2]
    assert table["clips"].tolist() == [1, 1]


def test_the_same_bytes_are_never_decoded_twice(
    raw: Path, roll: Roll, film: Film, ingest_params: Any, conversions: list[str]
) -> None:
    before = made(raw, ingest_params)
    assert conversions == ["one.mkv", "two b.mkv"]
    film(raw / "three.mkv", roll(count=30, seed=3), np.arange(30) / 200)
    (raw / "one.mkv").rename(raw / "four.mkv")
    after = made(raw, ingest_params, split={"valid": 0.0, "test": 1.0}, allow_unreadable=True)
    assert conversions == ["one.mkv", "two b.mkv", "three.mkv"]
    frames = {clip.name: clip.frames for clip in after}
    assert np.array_equal(frames["four_00"], before[0].frames)
    made(raw, ingest_params, size=40)
    assert len(conversions) == 6


def test_what_the_set_no_longer_uses_is_removed(raw: Path, ingest_params: Any, tmp_path: Path) -> None:
    store = tmp_path / "scratch" / "ingest" / "set"
    made(raw, ingest_params)
    assert len(list(store.iterdir())) == 2
    (raw / "one.mkv").unlink()
    made(raw, ingest_params)
    assert len(list(store.iterdir())) == 1
    made(raw, ingest_params, size=40)
    assert len(list(store.iterdir())) == 1


@pytest.fixture
def nested(tmp_path: Path, roll: Roll, film: Film) -> Path:
    """A set as others publish theirs: videos of the same name in several folders, notes and tables beside them."""
    for seed, name in enumerate(("PoolR/test/1.mkv", "PoolR/train/1.mkv", "PoolR/train/2.mkv", "BowlR/1.mkv")):
        film(tmp_path / "raw" / name, roll(count=40, seed=seed), np.arange(40) / 200)
    for name in ("README.txt", "PoolR/meta.json", "PoolR/train/list.txt", "PoolR/train/1.csv"):
        (tmp_path / "raw" / name).write_text("words")
    return tmp_path / "raw"


def divided(raw: Path, **splits: str) -> None:
    """The set's split file, by the video's number: `PoolR/test/1.mkv` is t1, the next n1 and n2, the last b1."""
    names = {"t1": "PoolR/test/1.mkv", "n1": "PoolR/train/1", "n2": "PoolR/train/2.mkv", "b1": "BowlR/1"}
    rows = [f"{names[key]},{split}" for key, split in splits.items()]
    (raw / "splits.csv").write_text("\n".join(["recording,split", *rows]))


def test_folders_in_folders_keep_videos_of_one_name_apart(nested: Path, ingest_params: Any) -> None:
    found = made(nested, ingest_params)
    assert [clip.name for clip in found[::2]] == [
        "BowlR-1_00",
        "PoolR-test-1_00",
        "PoolR-train-1_00",
        "PoolR-train-2_00",
    ]
    assert [clip.source for clip in found[1::2]] == [
        "BowlR/1.mkv",
        "PoolR/test/1.mkv",
        "PoolR/train/1.mkv",
        "PoolR/train/2.mkv",
    ]
    assert len({clip.frames.tobytes() for clip in found}) == 8
    _, table = ingest("set", nested, IngestParams(**ingest_params))
    assert table["source"].tolist() == [clip.source for clip in found[::2]]


def test_a_split_file_decides_for_all_clips_of_a_recording(nested: Path, ingest_params: Any) -> None:
    divided(nested, t1="test", n1="train", n2="valid", b1="train")
    found = made(nested, ingest_params, split={"valid": 0.2, "test": 0.2})
    assert len(found) == 8
    assert {(clip.source, clip.split) for clip in found} == {
        ("BowlR/1.mkv", "train"),
        ("PoolR/test/1.mkv", "test"),
        ("PoolR/train/1.mkv", "train"),
        ("PoolR/train/2.mkv", "valid"),
    }


def test_another_split_file_decodes_nothing_again(nested: Path, ingest_params: Any, conversions: list[str]) -> None:
    before = made(nested, ingest_params)
    assert len(conversions) == 4
    divided(nested, t1="test", n1="train", n2="train", b1="test")
    made(nested, ingest_params)
    divided(nested, t1="train", n1="train", n2="test", b1="train")
    after = made(nested, ingest_params)
    assert len(conversions) == 4
    assert [clip.split for clip in after] == ["train"] * 6 + ["test"] * 2
    for one, other in zip(before, after, strict=True):
        assert np.array_equal(one.frames, other.frames)


def test_a_bad_split_file_is_refused_before_anything_is_decoded(
    nested: Path, ingest_params: Any, conversions: list[str]
) -> None:
    divided(nested, t1="test", n1="training", n2="train", b1="train")
    with (nested / "splits.csv").open("a") as file:
        file.write("\nPoolR/train/3.mkv,train")
    error = refusal(nested, ingest_params)
    assert error.where.endswith("splits.csv")
    assert "line 3: no split `training`" in error.reason
    assert "line 6: no recording `PoolR/train/3.mkv`" in error.reason
    assert conversions == []


def test_a_process_pool_gives_the_same_clips(
    raw: Path, ingest_params: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    alone = made(raw, ingest_params)
    monkeypatch.setenv("PHYSPIPE_SCRATCH", str(tmp_path / "elsewhere"))
    monkeypatch.setenv("PHYSPIPE_WORKERS", "2")
    for one, other in zip(alone, made(raw, ingest_params), strict=True):
        assert one.name == other.name
        assert np.array_equal(one.frames, other.frames)


def test_all_unreadable_recordings_are_named_at_once(raw: Path, roll: Roll, film: Film, ingest_params: Any) -> None:
    (raw / "bad.mp4").write_text("words")
    (raw / "empty.mp4").touch()
    film(raw / "same.mkv", np.repeat(roll(count=1), 9, axis=0), np.arange(9) / 200)
    error = refusal(raw, ingest_params)
    assert "3 of 5 recordings" in error.reason
    for name, reason in (
        ("bad.mp4", "not a readable video"),
        ("empty.mp4", "the file is empty"),
        ("same.mkv", "nothing moves"),
    ):
        assert f"{name}: {reason}" in error.reason


def test_unreadable_recordings_may_be_left_out_by_wish(
    raw: Path, ingest_params: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    (raw / "bad.mp4").write_text("words")
    film, table = ingest("set", raw, IngestParams(**{**ingest_params, "allow_unreadable": True}))
    assert {clip.source for clip in film} == {"one.mkv", "two b.mkv"}
    assert table.set_index("source").loc["bad.mp4", "clips"] == 0
    assert "bad.mp4: not a readable video" in capsys.readouterr().err
    for path in raw.glob("*.mkv"):
        path.unlink()
    assert "1 of 1 recordings" in refusal(raw, ingest_params, allow_unreadable=True).reason


def test_a_full_disk_is_nobodys_fault_and_leaves_nothing(
    raw: Path, ingest_params: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("physpipe.io.packed.Writer.add", full)
    assert isinstance(refusal(raw, ingest_params, allow_unreadable=True), DiskFullError)
    assert list((tmp_path / "scratch" / "ingest" / "set").iterdir()) == []


def test_recordings_whose_clips_would_share_a_name_are_refused(raw: Path, ingest_params: Any) -> None:
    shutil.copy(raw / "two b.mkv", raw / "Two-b.mkv")
    error = refusal(raw, ingest_params)
    assert "would be named as those of" in error.reason


def test_an_empty_folder_is_refused(tmp_path: Path, ingest_params: Any) -> None:
    (tmp_path / "raw").mkdir()
    assert "holds no recording" in refusal(tmp_path / "raw", ingest_params).reason


def test_an_empty_split_is_refused_unless_its_share_is_zero(raw: Path, ingest_params: Any) -> None:
    error = refusal(raw, ingest_params, split={"valid": 0.0, "test": 1e-9})
    assert "no clip falls into the split `test` (train 5, valid 0, test 0)" in error.reason
    assert "set its share to 0" in error.mend


def test_names_are_safe_everywhere() -> None:
    assert clip_name("mit Öl/ball (1).final", 3) == "mit-l-ball-1-final_03"


def test_gaps_and_lost_frames_reach_the_clip_table(tmp_path: Path, roll: Roll, film: Film, ingest_params: Any) -> None:
    times = np.delete(np.arange(40), range(20, 25)) / 50
    film(tmp_path / "raw" / "a.mkv", roll(count=35), times)
    found, table = ingest("set", tmp_path / "raw", IngestParams(**{**ingest_params, "fps": 50.0, "clip_frames": 40}))
    clips.save(tmp_path / "clips", found, table)
    rows = ClipSet(tmp_path / "clips").rows("a_00")
    assert len(rows) == 40
    assert rows.loc[rows["status"] == "missing", "frame"].tolist() == [21, 22, 23]
    assert table["missing"].tolist() == [3]
    assert "5 frames were never stored" in table["warnings"][0]
