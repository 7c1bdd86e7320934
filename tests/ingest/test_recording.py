"""One recording to pictures and rows: cut, trimmed, refused."""

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.ingest.recording import ConvertParams, convert
from physpipe.io.packed import Packed

Roll = Callable[..., NDArray[np.uint8]]
Film = Callable[..., Path]


@pytest.fixture
def options(ingest_params: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in ingest_params.items() if key in ConvertParams.model_fields}


def converted(path: Path, options: dict[str, Any], **changes: Any) -> Packed:
    folder = path.parent / "packed"
    convert(path, folder, ConvertParams(**{**options, **changes}))
    return Packed(folder)


def test_pictures_lie_flush_with_the_rows_that_show_them(tmp_path: Path, roll: Roll, film: Film, options: Any) -> None:
    frames = roll(count=60)
    path = film(tmp_path / "a.mkv", frames, np.arange(60) / 200)
    crop = {"left": 0, "top": 0, "width": 96, "height": 64}
    found = converted(path, options, fps=50.0, crop=crop, size=32)
    assert found.rows["source_frame"].tolist() == list(range(0, 60, 4))
    means = frames[::4].reshape(15, 32, 2, 32, 3, 3).mean(axis=(2, 4))
    shown = found.pictures[found.rows["picture"].to_numpy()]
    assert np.abs(shown - means).max() <= 0.5 + 1e-6  # grey levels: the film is lossless, the mean is rounded


def test_a_long_recording_is_cut_and_a_short_remainder_counted(
    tmp_path: Path, roll: Roll, film: Film, options: Any
) -> None:
    path = film(tmp_path / "a.mkv", roll(count=48), np.arange(48) / 50)
    kept = converted(path, options, clip_frames=20, min_frames=8)
    assert kept.rows.groupby("part").size().tolist() == [20, 20, 8]
    assert kept.summary["dropped"] == 0
    dropped = converted(path, options, clip_frames=20, min_frames=9)
    assert dropped.rows.groupby("part").size().tolist() == [20, 20]
    assert dropped.summary["kept"] == 40
    assert dropped.summary["dropped"] == 8


def test_no_clip_spans_a_hole(tmp_path: Path, roll: Roll, film: Film, options: Any) -> None:
    times = np.concatenate([np.arange(24), 200 + np.arange(24)]) / 50
    found = converted(film(tmp_path / "a.mkv", roll(count=48), times), options, clip_frames=20, min_frames=5)
    assert found.rows.groupby("part").size().tolist() == [20, 20]
    assert found.rows.groupby("part")["source_frame"].first().tolist() == [0, 24]


def test_only_the_moving_part_is_kept(tmp_path: Path, roll: Roll, film: Film, options: Any, trim: Any) -> None:
    frames = roll(count=80, start=25, stop=55, noise=2.0, drift=0.1, wobble=1.0)
    path = film(tmp_path / "a.mkv", frames, np.arange(80) / 50)
    crop = {"left": 0, "top": 0, "width": 96, "height": 64}
    found = converted(path, options, trim=trim, size=64, crop=crop, clip_frames=60)
    assert found.rows["source_frame"].min() == pytest.approx(25, abs=2)
    assert found.rows["source_frame"].max() == pytest.approx(55, abs=2)


def test_a_recording_in_which_nothing_moves_is_refused(
    tmp_path: Path, roll: Roll, film: Film, options: Any, trim: Any
) -> None:
    same = film(tmp_path / "same.mkv", np.repeat(roll(count=1), 20, axis=0), np.arange(20) / 50)
    for trimming in (None, trim):
        with pytest.raises(InputError, match=r"same.mkv: nothing moves"):
            converted(same, options, trim=trimming)
    noisy = film(tmp_path / "noisy.mkv", roll(count=20, speed=0, noise=3.0), np.arange(20) / 50)
    with pytest.raises(InputError, match=r"noisy.mkv: nothing moves"):
        converted(noisy, options, trim=trim)
    assert len(converted(noisy, options).rows) == 20


def test_too_short_a_recording_is_refused(tmp_path: Path, roll: Roll, film: Film, options: Any) -> None:
    path = film(tmp_path / "a.mkv", roll(count=4, start=0), np.arange(4) / 50)
    with pytest.raises(InputError, match="4 frames only; a clip has at least 5"):
        converted(path, options)
    assert [each.name for each in tmp_path.iterdir()] == ["a.mkv"]


def test_a_recording_with_no_decodable_frame_is_refused(tmp_path: Path, options: Any) -> None:
    (tmp_path / "burst").mkdir()
    (tmp_path / "burst" / "1.png").write_bytes(b"broken")
    with pytest.raises(InputError, match="no frame that can be decoded"):
        converted(tmp_path / "burst", options, source_fps=10.0)


def test_images_of_two_sizes_are_refused(tmp_path: Path, roll: Roll, options: Any) -> None:
    (tmp_path / "burst").mkdir()
    for number in range(6):
        cv2.imwrite(str(tmp_path / "burst" / f"{number}.png"), roll(count=1, width=96 - 8 * (number == 4))[0])
    with pytest.raises(InputError, match=r"frame 4 is \(64, 88\) px"):
        converted(tmp_path / "burst", options, source_fps=10.0)


def test_memory_does_not_grow_with_the_recording(
    tmp_path: Path, roll: Roll, film: Film, options: Any, trim: Any
) -> None:
    frames = roll(count=50, start=0, stop=50, noise=2.0)
    path = film(tmp_path / "a.mkv", np.concatenate([frames, frames[::-1]] * 4), np.arange(400) / 50)
    tracemalloc.start()
    found = converted(path, options, size=128, trim=trim)
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.pictures.nbytes > 18e6
    assert peak_bytes < 6e6


def test_the_params_refuse_what_cannot_be(options: Any) -> None:
    for change in ({"clip_frames": 4}, {"min_frames": 21}, {"fps": 0}, {"size": 33}, {"max_gap_s": 0}):
        with pytest.raises(ValidationError):
            ConvertParams(**{**options, **change})
