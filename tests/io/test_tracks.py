"""The track table: what it holds, and what it refuses."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import clips, tables, tracks
from physpipe.io.clips import Clip, ClipSet

H, W, T, K = 24, 40, 5, 2
GEOMETRY = Geometry(100, 60, 4 * W, 4 * H, W, H)
TIMES_S = np.arange(T) / 80


@pytest.fixture
def film(tmp_path: Path) -> ClipSet:
    numbers = np.arange(T, dtype=np.int32)
    frames, status = np.zeros((T, H, W, 3), np.uint8), np.array(["ok"] * T)
    made = [Clip(name, "test", "s.mp4", GEOMETRY, frames, TIMES_S, numbers, TIMES_S, status) for name in "ab"]
    clips.save(tmp_path / "clips", made)
    return ClipSet(tmp_path / "clips")


def positions(seed: int) -> np.ndarray:
    xy = np.random.default_rng(seed).uniform(0, 20, (T, K, 2))
    xy[3, 1] = np.nan
    return xy


def table() -> pd.DataFrame:
    return pd.concat([tracks.rows(name, TIMES_S, positions(seed), np.ones((T, K))) for seed, name in enumerate("ba")])


def test_positions_come_back_and_a_lost_object_keeps_its_rows(tmp_path: Path, film: ClipSet) -> None:
    tracks.save(tmp_path / "t.parquet", table(), "test", film)
    found = tracks.load(tmp_path / "t.parquet")
    assert found["clip"].tolist() == ["a"] * T * K + ["b"] * T * K
    for name, seed in (("b", 0), ("a", 1)):
        np.testing.assert_allclose(tracks.positions(found, name), positions(seed), atol=1e-5)  # float32 pixels
    lost = found[(found["clip"] == "a") & (found["object"] == 1) & (found["frame"] == 3)].iloc[0]
    assert not lost["visible"]
    assert lost["status"] == "lost"
    assert lost["score"] == 0
    assert lost["time_s"] == TIMES_S[3]
    assert tracks.object_count(tmp_path, found) == K
    assert set(tracks.by_clip(found)) == {"a", "b"}


def test_the_metadata_lead_back_to_the_source(tmp_path: Path, film: ClipSet) -> None:
    tracks.save(tmp_path / "t.parquet", table(), "test", film)
    said = tables.metadata(tmp_path / "t.parquet")
    assert said["producer"] == "test"
    assert said["geometry"]["a"] == [100, 60, 4 * W, 4 * H, W, H]  # type: ignore[index]


@pytest.mark.parametrize(
    ("fault", "column", "value"),
    [
        ("repeats clip, object, frame", "frame", 1),
        ("score outside", "score", 1.5),
        ("visible without a position", "x", np.nan),
        ("lacks rows", "frame", 9),
    ],
)
def test_a_broken_table_is_refused_when_saved(
    tmp_path: Path, film: ClipSet, fault: str, column: str, value: float
) -> None:
    broken = table().reset_index(drop=True)
    broken.loc[T - 1, column] = value
    with pytest.raises(InputError, match=fault):
        tracks.save(tmp_path / "t.parquet", broken, "test", film)
    assert not (tmp_path / "t.parquet").exists()


def test_a_position_that_is_not_visible_is_refused(tmp_path: Path) -> None:
    broken = table().reset_index(drop=True)
    broken.loc[0, "visible"] = False
    with pytest.raises(InputError, match="has a position but is not visible"):
        tracks.check(tmp_path, broken)


def test_objects_must_be_as_many_in_every_frame_and_clip(tmp_path: Path) -> None:
    one = tracks.rows("a", TIMES_S, positions(0)[:, :1], np.ones((T, 1)))
    two = tracks.rows("b", TIMES_S, positions(0), np.ones((T, K)))
    with pytest.raises(InputError, match=r"clips with \[1, 2\] objects"):
        tracks.object_count(tmp_path, pd.concat([one, two]))
    with pytest.raises(InputError, match="clip b lacks rows"):
        tracks.check(tmp_path, two[~((two["object"] == 1) & (two["frame"] == T - 1))])


def test_an_empty_table_can_be_saved(tmp_path: Path, film: ClipSet) -> None:
    tracks.save(tmp_path / "t.parquet", tracks.empty(), "test", film)
    assert tracks.load(tmp_path / "t.parquet").empty


def test_absent_and_foreign_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        tracks.load(tmp_path / "t.parquet")
    pd.DataFrame({"clip": ["a"]}).to_parquet(tmp_path / "t.parquet")
    with pytest.raises(InputError, match="not a track table"):
        tracks.load(tmp_path / "t.parquet")
    with pytest.raises(KeyError):
        tracks.positions(table(), "z")


def test_a_folder_of_tables_comes_back_by_tracker(tmp_path: Path, film: ClipSet) -> None:
    tracks.save_folder(tmp_path / "all", {"lab": table(), "centre": table()}, "test", film)
    assert list(tracks.load_folder(tmp_path / "all")) == ["centre", "lab"]


def test_doubtful_rows_are_found_again_by_clip_object_and_frame(tmp_path: Path, film: ClipSet) -> None:
    status = np.full((T, K), "tracked", object)
    status[2, 0] = status[3, 1] = tracks.AMBIGUOUS
    tracks.save(tmp_path / "t.parquet", tracks.rows("a", TIMES_S, positions(0), np.ones((T, K)), status), "test", film)
    flagged = tracks.ambiguous(tracks.load(tmp_path / "t.parquet"))
    expected = status == tracks.AMBIGUOUS
    expected[3, 1] = False  # that one is lost
    assert list(flagged) == ["a"]
    np.testing.assert_array_equal(flagged["a"], expected)
