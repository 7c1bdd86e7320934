"""Clips on disk: what is saved comes back, and a folder appears only when complete."""

import errno
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import clips
from physpipe.io.clips import Clip, ClipSet

H, W, T = 24, 40, 6
GEOMETRY = Geometry(100, 60, 4 * W, 4 * H, W, H)


def clip(name: str, split: clips.Split = "train", geometry: Geometry = GEOMETRY) -> Clip:
    rng = np.random.default_rng(sum(name.encode()))
    return Clip(
        name=name,
        split=split,
        source=f"{name}.mp4",
        geometry=geometry,
        frames=rng.integers(0, 256, (T, geometry.height, geometry.width, 3)).astype(np.uint8),
        times_s=np.arange(T) / 80,
        source_frames=np.arange(7, 7 + 3 * T, 3, dtype=np.int32),
        source_times_s=1 + np.arange(T) / 80,
        status=np.array(["ok", "missing", "decode_error", "ok", "ok", "ok"]),
    )


def test_what_is_saved_comes_back(tmp_path: Path) -> None:
    made = [clip("b", "test"), clip("a")]
    clips.save(tmp_path / "set", made)
    found = ClipSet(tmp_path / "set")
    assert found.names() == ["a", "b"]
    assert found.names("test") == ["b"]
    for each in made:
        assert np.array_equal(found.frames(each.name), each.frames)
        assert np.array_equal(found.times_s(each.name), each.times_s)
        assert found.geometry(each.name) == each.geometry
        rows = found.rows(each.name)
        assert rows["status"].tolist() == each.status.tolist()
        assert rows["source_frame"].tolist() == each.source_frames.tolist()
        assert rows["source_time_s"].tolist() == each.source_times_s.tolist()
        assert rows["frame"].tolist() == list(range(T))
    assert list(found.table.columns) == clips.COLUMNS


def test_the_recordings_table_lies_beside_the_clips(tmp_path: Path) -> None:
    table = pd.DataFrame({"source": ["a.mp4"], "measured_fps": [239.97], "warnings": ["variable rate: 3 %"]})
    clips.save(tmp_path / "set", [clip("a")], table)
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "set" / clips.RECORDINGS), table)


def test_a_full_disk_leaves_the_older_folder_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clips.save(tmp_path / "set", [clip("old")])

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "save", full)
    with pytest.raises(InputError, match="disk is full") as caught:
        clips.save(tmp_path / "set", [clip("new")])
    assert caught.value.where == str(tmp_path / "set")
    assert [path.name for path in tmp_path.iterdir()] == ["set"]
    assert ClipSet(tmp_path / "set").names() == ["old"]


def test_an_error_after_the_first_clip_leaves_nothing(tmp_path: Path) -> None:
    def stopped() -> Iterator[Clip]:
        yield clip("a")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        clips.save(tmp_path / "set", stopped())
    assert list(tmp_path.iterdir()) == []


def test_no_clips_and_no_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no clip to save"):
        clips.save(tmp_path / "set", [])
    with pytest.raises(InputError, match="no such file"):
        ClipSet(tmp_path / "set")


def test_an_unknown_clip_is_refused_by_name(tmp_path: Path) -> None:
    clips.save(tmp_path / "set", [clip("a")])
    with pytest.raises(InputError, match="no clip `z`"):
        ClipSet(tmp_path / "set").rows("z")


def test_the_common_size_is_height_then_width_and_must_be_one(tmp_path: Path) -> None:
    clips.save(tmp_path / "one", [clip("a"), clip("b")])
    assert clips.common_size(ClipSet(tmp_path / "one")) == (H, W)
    clips.save(tmp_path / "two", [clip("a"), clip("b", geometry=Geometry(0, 0, W, W, W, W))])
    with pytest.raises(InputError, match="several sizes"):
        clips.common_size(ClipSet(tmp_path / "two"))
