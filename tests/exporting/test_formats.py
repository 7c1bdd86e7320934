"""Every format, read back by the program that it is for where that is installed, else by its documented layout."""

from configparser import ConfigParser

import numpy as np
import pandas as pd
import pytest

from physpipe.commands import words
from physpipe.exporting.formats import FORMATS

CLIPS = ("film_00", "film_01")
FRAMES = 20
SEEN = {0: 20, 1: 16}
"""Frames in which each object is seen."""
TRACKEVAL = (
    "trackeval 1.3.0 requires opencv-python, whose files opencv-python-headless overwrites; "
    "passed by hand at commit 7c7f2b4, installed by `pip install --no-deps trackeval tabulate pycocotools`"
)
MOVEMENT = "movement 0.15.0 brings 68 packages, 700 MB, beside ours; passed by hand at commit 7c7f2b4"
"""Why these two are in no extra, and which version read these files of which commit."""


def true(balls, clip: str, obj: int) -> np.ndarray:
    return balls.table[(balls.table["clip"] == clip) & (balls.table["object"] == obj)][["x", "y"]].to_numpy()


def test_every_format_can_be_asked_for():
    assert tuple(FORMATS) == words.FORMATS


def test_csv_holds_every_row(balls, tmp_path):
    FORMATS["csv"](tmp_path, balls.located(scale=100.0))
    table = pd.read_csv(tmp_path / "tracks.csv")
    assert len(table) == 2 * 2 * FRAMES
    np.testing.assert_allclose(table[["x", "y"]], balls.table[["x", "y"]], atol=1e-4)  # pixels
    assert table.columns.tolist()[:9] == balls.table.columns.tolist()
    assert {"source", "source_frame", "source_time_s", "frame_status", "x_m", "y_m"} <= set(table)
    assert table["visible"].sum() == 2 * sum(SEEN.values())


def test_trackpy_measures_the_motion_that_there_is(balls, tmp_path):
    trackpy = pytest.importorskip("trackpy", reason="extra `bench` is not installed")
    FORMATS["trackpy"](tmp_path, balls.located("source", scale=100.0))
    table = pd.read_csv(tmp_path / "trackpy.csv")
    assert table["particle"].nunique() == 4  # two objects of two clips
    assert table.groupby("particle").size().tolist() == [20, 16, 20, 16]
    moving = table[table["particle"] == 0]
    # 100 px a metre and 100 frames/s: half a pixel a frame is half a metre a second
    msd = trackpy.imsd(moving, mpp=0.01, fps=100, max_lagtime=10)[0].dropna()  # every second frame was tracked
    assert len(msd) == 5
    np.testing.assert_allclose(msd, (0.5**2 + 0.25**2) * msd.index.to_numpy() ** 2, rtol=1e-3)
    assert len(trackpy.filter_stubs(table, 18)["particle"].unique()) == 2
    np.testing.assert_allclose(table[["x", "y"]] / 100, table[["x_m", "y_m"]], atol=1e-5)


@pytest.mark.parametrize("pixels", ["clip", "source"])
def test_mot_has_ten_columns_that_count_from_one(balls, tmp_path, pixels):
    tracks = balls.located(pixels)
    FORMATS["mot"](tmp_path, tracks)
    for clip in CLIPS:
        rows = np.loadtxt(tmp_path / f"{clip}.txt", delimiter=",")
        assert rows.shape == (sum(SEEN.values()), 10)
        frame, number, left, top, width, height, confidence = rows.T[:7]
        assert (np.diff(frame) >= 0).all()
        assert set(number) == {1, 2}
        mine = tracks.counted[tracks.counted["clip"] == clip].sort_values(["frame", "object"])
        assert frame.tolist() == (mine["frame"] + 1).tolist()
        # A box from pixel 1 to pixel 6 has its middle at 3.5, which is 2.5 for us, who count from 0
        np.testing.assert_allclose(left + (width - 1) / 2 - 1, mine["x"], atol=1e-3)  # pixels
        np.testing.assert_allclose(top + (height - 1) / 2 - 1, mine["y"], atol=1e-3)
        assert (width[0], height[0]) == ((6, 6) if pixels == "clip" else (12, 9))
        assert set(confidence) == {0.75}
        assert (rows[:, 7:] == -1).all()


def test_mot_says_what_a_sequence_is(balls, tmp_path):
    FORMATS["mot"](tmp_path, balls.located(scale=100.0))
    parser = ConfigParser()
    parser.read(tmp_path / "film_01" / "seqinfo.ini")
    said = dict(parser["Sequence"])
    assert said == {"name": "film_01", "framerate": "50", "seqlength": "20", "imwidth": "30", "imheight": "32"}
    assert "frameRate=50\n" in (tmp_path / "film_01" / "seqinfo.ini").read_text()
    world = np.loadtxt(tmp_path / "film_00.txt", delimiter=",")[:, 7:]
    np.testing.assert_allclose(world[0], [0.18, 0.14, -1], atol=1e-4)  # metres


def test_trackeval_reads_the_boxes(balls, tmp_path):
    trackeval = pytest.importorskip("trackeval", reason=TRACKEVAL)
    ours = tmp_path / "t" / "ours" / "data"
    ours.mkdir(parents=True)
    FORMATS["mot"](ours, balls.located())
    for clip in CLIPS:
        truth = tmp_path / "gt" / clip
        (truth / "gt").mkdir(parents=True)
        (truth / "gt" / "gt.txt").write_text((ours / f"{clip}.txt").read_text())
        (truth / "seqinfo.ini").write_text((ours / clip / "seqinfo.ini").read_text())
    config = {
        "GT_FOLDER": str(tmp_path / "gt"),
        "TRACKERS_FOLDER": str(tmp_path / "t"),
        "SEQ_INFO": dict.fromkeys(CLIPS),
        "SKIP_SPLIT_FOL": True,
        "DO_PREPROC": False,
        "PRINT_CONFIG": False,
    }
    data = trackeval.datasets.MotChallenge2DBox(config).get_raw_seq_data("ours", "film_00")
    assert data["num_timesteps"] == FRAMES
    assert [len(each) for each in data["tracker_ids"]] == [2] * 8 + [1] * 4 + [2] * 8
    assert (np.diag(data["similarity_scores"][0]) == 1).all()


@pytest.mark.parametrize("pixels", ["clip", "source"])
def test_movement_tables_have_deeplabcut_s_four_header_rows(balls, tmp_path, pixels):
    tracks = balls.located(pixels)
    FORMATS["movement"](tmp_path, tracks)
    table = pd.read_csv(tmp_path / "film_00.csv", header=[0, 1, 2, 3], index_col=0)
    assert table.columns.names == ["scorer", "individuals", "bodyparts", "coords"]
    assert table.index.tolist() == list(range(FRAMES))
    first = table["physpipe", "object_0", "centre"]
    expected = true(balls, "film_00", 0) if pixels == "clip" else balls.source_xy[0, :, 0]
    np.testing.assert_allclose(first[["x", "y"]], expected, atol=1e-3)  # pixels
    lost = table["physpipe", "object_1", "centre"].iloc[8:12]
    assert lost[["x", "y"]].isna().all(axis=None)
    assert (lost["likelihood"] == 0).all()


def test_movement_loads_them(balls, tmp_path):
    loading = pytest.importorskip("movement.io.load_poses", reason=MOVEMENT)
    FORMATS["movement"](tmp_path, balls.located())
    data = loading.from_dlc_file(tmp_path / "film_01.csv", fps=50)
    individual = next(name for name in data.dims if name.startswith("individual"))
    assert data.sizes["time"] == FRAMES
    assert data.coords[individual].to_numpy().tolist() == ["object_0", "object_1"]
    position = data["position"].squeeze().sel({individual: "object_0"}).transpose("time", "space")
    np.testing.assert_allclose(position, true(balls, "film_01", 0), atol=1e-3)  # pixels
    np.testing.assert_allclose(data["time"], np.arange(FRAMES) / 50)
