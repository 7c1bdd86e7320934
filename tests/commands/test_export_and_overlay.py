"""Exports and overlay films of a set, by the command."""

import json
from pathlib import Path

import av
import pandas as pd
import pytest

from physpipe.io import tracks


@pytest.mark.parametrize(
    ("to", "files"),
    [
        ("csv", ["tracks.csv"]),
        ("trackpy", ["trackpy.csv"]),
        ("mot", ["one_00", "one_00.txt", "two_00", "two_00.txt"]),
        ("movement", ["one_00.csv", "two_00.csv"]),
    ],
)
def test_an_export_is_a_folder_that_says_what_it_is(run, balls, to, files):
    assert "2 clips, 24 rows in clip pixels, metres at 200 px per metre" in run("export", "balls", "--to", to)
    folder = Path("exports/balls") / to
    assert sorted(path.name for path in folder.iterdir()) == sorted(["about.json", *files])
    about = json.loads((folder / "about.json").read_text())
    assert (about["set"], about["pixels"], about["pixels_per_metre"]) == ("balls", "clip", 200)
    assert (about["frames_per_s"], about["clip_frames_per_s"]) == (50, 50)
    written = [path for path in folder.rglob("*.*") if path.name != "about.json"]
    assert about["files"] == sorted(path.relative_to(folder).as_posix() for path in written)
    assert about["tracks"] == "data/tracks/balls.parquet"


def test_the_user_s_scale_and_table_go_first(run, balls):
    words = ["--to", "csv", "--pixels-per-metre", 100, "--table", "data/truth/balls.parquet", "--out", "mine"]
    run("export", "balls", *words)
    table = pd.read_csv("mine/tracks.csv")
    assert table["x_m"].iloc[0] == pytest.approx(0.2)
    assert json.loads(Path("mine/about.json").read_text())["tracks"] == "data/truth/balls.parquet"


def test_a_simulated_set_has_its_camera_s_scale(run, balls):
    for place in ("clips", "tracks"):
        for path in Path("data", place).glob("balls*"):
            path.rename(path.with_name(path.name.replace("balls", "bowls")))
    assert "metres at 112.2 px per metre" in run("export", "bowls", "--to", "csv")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["export", "bals", "--to", "csv"], "no data set `bals` (did you mean `balls`?)"),
        (["export", "pendulum", "--to", "csv"], "data/tracks/pendulum.parquet: no such file"),
        (["export", "pendulum", "--to", "csv"], 'then `dvc exp run -S "run.datasets=[pendulum]" -S "run.simulated=[]"'),
        (["export", "bowls", "--to", "csv"], "To mend: run `dvc repro`, which makes it"),
        (["export", "balls", "--to", "csv", "--table", "absent.parquet"], "To mend: give one that is there"),
        (["export", "balls", "--to", "csv", "--out", "params.yaml/x"], "cannot be written"),
        (["export", "balls", "--to", "csv", "--out", "."], "holds other files"),
        (["export", "balls", "--to", "csv", "--pixels-per-metre", "0"], "0 is no scale"),
        (["overlay", "pendulum"], "data/tracks/pendulum.parquet: no such file"),
        (["overlay", "pendulum"], 'then `dvc exp run -S "run.datasets=[pendulum]" -S "run.simulated=[]"'),
        (["overlay", "balls", "--split", "valid"], "no tracks of these clips"),
        (["overlay", "balls", "--clips", "three_00"], "no clip `three_00`"),
        (["overlay", "balls", "--predictor", "oracle"], "oracle.parquet: no such file"),
        (["overlay", "balls", "--slower", "0"], "0 is no factor"),
    ],
)
def test_a_refusal_is_one_line_and_writes_nothing(run, balls, project, words, said):
    before = sorted(project.rglob("*"))
    with pytest.raises(SystemExit, match=r"^error: ") as ended:
        run(*words)
    assert said in str(ended.value).replace("\\", "/")
    assert sorted(project.rglob("*")) == before


@pytest.mark.parametrize("pixels", ["clip", "source"])
def test_overlays_are_of_the_test_clips_at_the_true_rate(run, balls, pixels):
    assert "1 film: " in run("overlay", "balls", "--pixels", pixels)
    assert sorted(path.name for path in Path("exports/balls/overlay").iterdir()) == ["about.json", "two_00.mp4"]
    with av.open("exports/balls/overlay/two_00.mp4") as container:
        stream = container.streams.video[0]
        assert (stream.frames, float(stream.average_rate)) == (12, pytest.approx(50, rel=0.01))
        assert stream.width == (192 if pixels == "clip" else 64)  # the report's enlargement is 3


@pytest.mark.parametrize("words", [["export", "balls", "--to", "csv"], ["overlay", "balls"]])
def test_tracks_without_a_position_are_the_tracker_s_trouble_not_the_words(run, balls, words):
    path = Path("data/tracks/balls.parquet")
    table = tracks.load(path).assign(x=float("nan"), y=float("nan"), visible=False, status="lost", score=0)
    tracks.save(path, table, "made up", balls)
    with pytest.raises(SystemExit, match=r"balls.parquet: no tracks: the tracker found nothing.*report/index.html"):
        run(*words)


def test_notes_in_an_earlier_export_are_kept(run, balls):
    run("export", "balls", "--to", "csv")
    Path("exports/balls/csv/notes.md").write_text("mine")
    with pytest.raises(SystemExit, match=r"exports/balls/csv: holds what is not of the earlier export: notes\.md"):
        run("export", "balls", "--to", "csv")
    assert Path("exports/balls/csv/notes.md").read_text() == "mine"


def test_clips_can_be_named_and_film_without_forecasts_drawn(run, balls):
    Path("data/forecasts/balls/tracks/dispnet.parquet").unlink()
    run("overlay", "balls", "--clips", "one_00", "--to", "webp", "--out", "mine")
    assert Path("mine/one_00.webp").read_bytes()[8:12] == b"WEBP"


def test_film_that_is_gone_leaves_no_overlay(run, balls):
    Path("data/raw/balls/two.mkv").unlink()
    with pytest.raises(SystemExit, match="no such film"):
        run("overlay", "balls", "--pixels", "source")
    assert not Path("exports/balls/overlay").exists()


def test_another_table_is_drawn_without_forecasts_unless_they_are_asked_for(run, balls):
    words = ["overlay", "balls", "--table", "data/truth/balls.parquet"]
    run(*words)
    run(*words, "--predictor", "dispnet")
    table = tracks.load(Path("data/truth/balls.parquet"))
    tracks.save(Path("data/truth/balls.parquet"), table[table["frame"] < 8], "made up", balls)
    with pytest.raises(SystemExit, match="forecasts objects or frames of clip two_00 that the tracks lack"):
        run(*words, "--predictor", "dispnet")
