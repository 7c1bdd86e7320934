"""Positions, frame numbers and metres are those of the pixels asked for."""

from dataclasses import replace

import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.exporting.located import located
from physpipe.io import tracks
from physpipe.io.clips import ClipSet


def of(table, clip: str, obj: int):
    return table[(table["clip"] == clip) & (table["object"] == obj)]


def test_source_pixels_and_frames_are_the_film_s(balls):
    found = balls.located("source")
    for part, clip in enumerate(("film_00", "film_01")):
        rows = of(found.counted, clip, 0)
        np.testing.assert_allclose(rows[["x", "y"]], balls.source_xy[part, :, 0], atol=1e-4)  # pixels
        assert rows["frame"].tolist() == list(range(40 * part, 40 * part + 40, 2))
    assert found.fps("film_01") == pytest.approx(100)
    assert found.clip_fps("film_01") == pytest.approx(50)
    assert found.last_frame("film_01") == 78
    assert found.pixels_per_clip_pixel("film_00") == (2.0, 1.5)


def test_clip_pixels_and_frames_are_the_track_table_s(balls):
    found = balls.located()
    mine = of(balls.table, "film_01", 0)
    np.testing.assert_array_equal(of(found.counted, "film_01", 0)[["frame", "x", "y"]], mine[["frame", "x", "y"]])
    assert found.fps("film_00") == pytest.approx(50)
    assert found.pixels_per_clip_pixel("film_00") == (1.0, 1.0)


@pytest.mark.parametrize("pixels", ["clip", "source"])
def test_metres_do_not_depend_on_the_pixels(balls, pixels):
    rows = of(balls.located(pixels, scale=250.0).table, "film_00", 0)
    np.testing.assert_allclose(rows[["x_m", "y_m"]], balls.source_xy[0, :, 0] / 250, atol=1e-6)  # metres
    assert "x_m" not in balls.located(pixels).table


def test_lost_objects_keep_their_rows_but_do_not_count(balls):
    found = balls.located()
    lost = of(found.table, "film_00", 1).iloc[8:12]
    assert lost[["x", "y"]].isna().all(axis=None)
    assert lost["source_frame"].tolist() == [16, 18, 20, 22]
    assert set(of(found.counted, "film_00", 1)["frame"]) == {*range(8), *range(12, 20)}


def test_a_frame_that_shows_an_older_picture_counts_once_in_the_film(balls):
    found = balls.located("source")
    table = found.table.copy()
    here = table["clip"] == "film_00"
    table.loc[here & (table["frame"] == 3), "source_frame"] = 4  # as frame 2
    table.loc[here & (table["frame"] == 5), "frame_status"] = "missing"
    frames = of(replace(found, table=table).counted, "film_00", 0)["frame"]
    assert frames.tolist() == [0, 2, 4, *range(8, 10, 2), *range(12, 40, 2)]


def test_a_rate_is_said_once_where_all_clips_have_it_and_else_for_each(balls, tmp_path):
    about = balls.located("source").about("csv", balls.path)
    assert (about["frames_per_s"], about["clip_frames_per_s"]) == (pytest.approx(100), pytest.approx(50))
    slower = balls.clips.table.copy()
    slower.loc[slower["clip"] == "film_01", ["time_s", "source_time_s"]] *= 2
    slower.to_parquet(tmp_path / "clips.parquet")
    about = replace(balls.located("source"), clips=ClipSet(tmp_path)).about("csv", balls.path)
    assert about["frames_per_s"] == {"film_00": pytest.approx(100), "film_01": pytest.approx(50)}
    assert about["clip_frames_per_s"] == {"film_00": pytest.approx(50), "film_01": pytest.approx(25)}


def test_no_tracks_and_foreign_tracks_are_refused(balls):
    lost = balls.table.assign(x=np.float32(np.nan), y=np.float32(np.nan), visible=False, status="lost")
    for nothing in (tracks.empty(), lost):
        with pytest.raises(InputError, match="no tracks: the tracker found nothing") as caught:
            located("balls", balls.path, nothing, balls.clips, "clip", 3.0, None)
        assert "report/index.html" in caught.value.mend
        assert "--table" in caught.value.mend
    foreign = balls.table.assign(clip="other_00")
    with pytest.raises(InputError, match="tracks of clip other_00"):
        located(
            "balls", balls.path, foreign.drop_duplicates(["clip", "object", "frame"]), balls.clips, "clip", 3.0, None
        )
