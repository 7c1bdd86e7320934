"""Annotation files: what they mean, and every mistake named at once."""

from pathlib import Path

import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import annotations
from physpipe.io.annotations import Box
from physpipe.io.clips import Clip, ClipSet, save

H, W, T = 24, 40, 6
GEOMETRY = Geometry(100, 60, 4 * W, 4 * H, W, H)


@pytest.fixture
def clips(tmp_path: Path) -> ClipSet:
    """Clips `a` (every second frame of roll.mp4 from frame 10, the third one not decoded) and `b` (of still.mp4)."""
    made = []
    for name, source, numbers in (("a", "roll.mp4", 10 + 2 * np.arange(T)), ("b", "still.mp4", np.arange(T))):
        status = np.array(["ok"] * T, dtype=object)
        status[2] = "decode_error" if name == "a" else "ok"
        frames = np.zeros((T, H, W, 3), np.uint8)
        times = np.arange(T) / 30
        made.append(Clip(name, "test", source, GEOMETRY, frames, times, numbers.astype(np.int32), times, status))
    save(tmp_path / "clips", made)
    return ClipSet(tmp_path / "clips")


def written(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(text)
    return folder


def refusal(folder: Path, clips: ClipSet) -> str:
    with pytest.raises(InputError) as caught:
        annotations.load(folder, clips)
    return str(caught.value)


def test_a_folder_with_nothing_in_it_says_nothing(tmp_path: Path, clips: ClipSet) -> None:
    assert annotations.load(tmp_path / "absent", clips).clips() == []


def test_boxes_keep_their_centre_and_time_order(tmp_path: Path, clips: ClipSet) -> None:
    text = "clip,object,frame,x,y,w,h\na,1,4,3,5,7,9\n\na,1,0,0,0,40,24\nb,0,0,1.5,2,4,4\n"
    given = annotations.load(written(tmp_path / "said", "templates.csv", text), clips)
    assert given.boxes("a", 1) == [Box(0, 0, 0, 40, 24), Box(4, 3, 5, 7, 9)]
    assert given.boxes("a", 1)[1].centre == (6, 9)  # a box of pixels 3 ... 9 and 5 ... 13
    assert given.boxes("a", 0) == []
    assert given.clips() == ["a", "b"]
    assert (given.objects("a"), given.objects("b")) == (2, 1)


def test_every_bad_template_is_named_at_once(tmp_path: Path, clips: ClipSet) -> None:
    text = (
        "clip,object,frame,x,y,w,h\n"
        "a,0,0,35,5,6,6\n"  # line 2: pixels 35 ... 40 of 40
        "a,0,0,0,0,41,5\n"  # line 3: wider than the frame, and object 0, frame 0 once more
        "c,0,0,1,1,5,5\n"
        "a,0,6,1,1,5,5\n"
        "a,1,1,one,1,5,5\n"
        "a,1,2,1,1,5,2\n"
        "a,1.5,3,1,1,5,5\n"
        "b,0,0,34,18,6,6\n"  # line 9 is good: it ends on the last pixel
    )
    said = refusal(written(tmp_path / "said", "templates.csv", text), clips)
    for fault in (
        "template outside the frame: line 2;",
        "template larger than the clip's frame: line 3.",
        "repeats an earlier line: line 3;",
        "no such clip: line 4;",
        "frame beyond the clip: line 5;",
        "`x` is not a number: line 6;",
        "template smaller than 3 pixels: line 7;",
        "`object` is not 0, 1, 2 ...: line 8;",
    ):
        assert fault.rstrip(";.") in said
    assert "templates.csv" in said
    assert " 9" not in said


def test_every_bad_correction_is_named_at_once(tmp_path: Path, clips: ClipSet) -> None:
    text = (
        "clip,object,frame,x,y,visible\n"
        "nowhere,0,0,1,1,true\n"
        "a,0,9,1,1,true\n"
        "a,0,1,,,true\n"
        "a,0,2,200,10,true\n"
        "a,0,3,1,1,perhaps\n"
        "a,0,4,,,false\n"  # line 7 is good: nothing to see, no position needed
        "a,0,5,1,,true\n"
    )
    said = refusal(written(tmp_path / "said", "corrections.csv", text), clips)
    for fault in (
        "no such clip: line 2",
        "frame beyond the clip: line 3",
        "visible without a position: line 4, 8",
        "position outside the frame (give clip pixels): line 5",
        "`visible` is not true or false: line 6",
        "`y` is not a number: line 8",
    ):
        assert fault in said
    assert "line 7" not in said


def test_a_missing_column_is_named(tmp_path: Path, clips: ClipSet) -> None:
    said = refusal(written(tmp_path / "said", "corrections.csv", "clip,object,x,y\na,0,1,1\n"), clips)
    assert "lacks column(s) frame, visible" in said


def test_a_reference_of_other_recordings_is_refused(tmp_path: Path, clips: ClipSet) -> None:
    said = refusal(written(tmp_path / "said", "reference.csv", "source,object,frame,x,y\nrol.mp4,0,10,1,1\n"), clips)
    assert "roll.mp4" in said


def test_reference_positions_come_back_to_the_same_source_pixels(tmp_path: Path, clips: ClipSet) -> None:
    source_xy = 110 + 13.7 * np.arange(30)[:, None] % [140, 80]  # recording's frame 0 ... 29
    rows = [f"roll.mp4,0,{n},{x},{y},hand" for n, (x, y) in enumerate(source_xy)]
    text = "\n".join(["source,object,frame,x,y,tag", *rows, "unused.mp4,0,0,1,1,"])
    reference = annotations.load(written(tmp_path / "said", "reference.csv", text), clips).reference
    assert set(reference["clip"]) == {"a"}
    assert reference["frame"].tolist() == [0, 1, 3, 4, 5]  # frame 2 shows an older picture
    inside = reference.dropna()
    back = GEOMETRY.to_source(inside[["x", "y"]])
    np.testing.assert_allclose(back, source_xy[10 + 2 * inside["frame"]], atol=1e-9)  # source pixels
    assert set(reference["tag"]) == {"hand"}


def test_a_reference_of_whole_numbers_is_read_like_any_other(tmp_path: Path, clips: ClipSet) -> None:
    text = "source,object,frame,x,y\nstill.mp4,0,0,130,70\nstill.mp4,0,1,131,70\n"
    reference = annotations.load(written(tmp_path / "said", "reference.csv", text), clips).reference
    assert reference["x"].diff().iloc[1] == pytest.approx(0.25)  # clip pixels are four source pixels wide


def test_an_object_beyond_the_crop_is_out_of_sight(tmp_path: Path, clips: ClipSet) -> None:
    text = "source,object,frame,x,y\nstill.mp4,0,0,99,70\nstill.mp4,0,1,100,70\nstill.mp4,0,2,,\n"
    reference = annotations.load(written(tmp_path / "said", "reference.csv", text), clips).reference
    assert reference["x"].isna().tolist() == [True, False, True]  # the crop begins at source pixel 100
