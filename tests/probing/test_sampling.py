"""Pairs are neighbours, from all over the film, and the clock says what header and timestamps say."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.probing import clock, sampling
from physpipe.probing.sampling import sample

H, W = 48, 80


def stripes(
    path: Path, count: int, gop: int = 12, rotation: int | None = None, tags: dict[str, str] | None = None
) -> Path:
    """A lossy film at 100 frames/s whose frame n is 20 + 2 n grey, with a key frame every `gop` frames."""
    with av.open(path, "w", options={"movflags": "use_metadata_tags"}) as container:
        stream = container.add_stream("libx264", rate=100, options={"g": str(gop), "sc_threshold": "0", "crf": "1"})
        stream.height, stream.width, stream.pix_fmt = H, W, "yuv420p"
        container.metadata.update(tags or {})
        if rotation is not None:
            stream.set_display_rotation(rotation)
        for number in range(count):
            frame = av.VideoFrame.from_ndarray(np.full((H, W, 3), 20 + 2 * number, np.uint8), format="rgb24")
            frame.pts, frame.time_base = number, Fraction(1, 100)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def numbers(picture: np.ndarray) -> float:
    return (float(picture.mean()) - 20) / 2


@pytest.mark.parametrize("most_pixels", [1e9, 40 * H * W], ids=["decoded whole", "bursts behind key frames"])
def test_pairs_are_neighbours_from_the_beginning_to_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most_pixels: float
) -> None:
    monkeypatch.setattr(sampling, "MOST_PIXELS", most_pixels)
    found = sample(stripes(tmp_path / "a.mp4", 100), None)
    places = np.array([pair.place * 100 for pair in found.pairs])
    first = np.array([numbers(pair.first) for pair in found.pairs])
    second = np.array([numbers(pair.second) for pair in found.pairs])
    np.testing.assert_allclose(first, places, atol=0.7)  # frames; a grey level is half a frame
    np.testing.assert_allclose(second - first, 1, atol=0.7)
    assert places.min() < 5
    assert places.max() > 80
    assert len(places) >= 12


def test_long_film_is_decoded_in_part_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "MOST_PIXELS", 40 * H * W)
    packets = [clock.Packet(n / 100, n, n % 12 == 0) for n in range(1000)]
    bursts = sampling._bursts(packets, 40)
    assert sum(length for _, length in bursts) <= 40
    assert all(packets[start].is_key for start, _ in bursts)
    assert sampling._bursts(packets[:30], 40) == [(0, 30)]
    assert sampling._bursts([each._replace(is_key=False) for each in packets], 40) == [(0, 40)]


def test_size_and_rotation_are_of_the_upright_picture(tmp_path: Path) -> None:
    found = sample(stripes(tmp_path / "a.mp4", 10, rotation=90), None)
    assert (found.width, found.height) == (H, W)
    assert found.rotation in (90, -90)
    assert found.pairs[0].first.shape == (W, H, 3)


def test_large_pictures_are_reduced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "LONGEST_PX", 40)
    found = sample(stripes(tmp_path / "a.mp4", 10), None)
    assert found.pairs[0].first.shape == (24, 40, 3)
    assert found.reduction == pytest.approx(2)
    assert (found.width, found.height) == (W, H)


def test_a_lying_header_is_told_from_the_timestamps(roll: Callable[..., Path]) -> None:
    found = sample(roll(fps=10.0), None).clock  # the header says 100
    assert (found.frames, found.claimed_fps) == (100, pytest.approx(100, rel=0.05))
    assert found.measured_fps == pytest.approx(10, rel=1e-3)
    assert found.length_s == pytest.approx(10, rel=1e-2)
    assert "the header claims" in found.warnings[0]


def test_a_variable_rate_is_measured(roll: Callable[..., Path]) -> None:
    times_s = np.arange(100) / 100 + 0.006 * (np.arange(100) % 3 == 0)
    found = sample(roll(times_s=times_s), None).clock
    assert found.uneven > 0.5
    assert any("variable rate" in each for each in found.warnings)


def test_what_the_user_says_is_true(roll: Callable[..., Path]) -> None:
    found = sample(roll(), 200.0).clock
    assert (found.measured_fps, found.length_s) == (pytest.approx(200), pytest.approx(0.5))


def test_slow_motion_that_says_so_is_believed(tmp_path: Path) -> None:
    found = sample(stripes(tmp_path / "a.mp4", 10, tags={"com.android.capture.fps": "240"}), None).clock
    assert found.tagged_fps == 240
    assert any("--source-fps 240" in each for each in found.warnings)


def test_of_a_very_long_file_only_the_beginning_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = stripes(tmp_path / "a.mp4", 100)
    monkeypatch.setattr(clock, "MOST_BYTES", path.stat().st_size / 3)
    found = sample(path, None)
    assert (found.clock.frames, found.clock.length_s) == (100, pytest.approx(1.0, abs=0.05))
    assert [each for each in found.clock.warnings if "ends early" in each] == []
    assert "only its first" in found.clock.warnings[-1]


def test_images_have_the_rate_that_the_user_says(tmp_path: Path) -> None:
    for number in range(12):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full((H, W, 3), 20 + 2 * number, np.uint8))
    found = sample(tmp_path, None)
    assert "--source-fps" in found.clock.warnings[0]
    assert [round(numbers(pair.first)) for pair in found.pairs] == list(range(11))
    assert sample(tmp_path, 24.0).clock.length_s == pytest.approx(0.5)


def test_frames_of_several_sizes_and_no_frames_are_refused(tmp_path: Path) -> None:
    for number in range(4):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.zeros((H + number // 2, W, 3), np.uint8))
    with pytest.raises(InputError, match="differ in size"):
        sample(tmp_path, None)
    (tmp_path / "one").mkdir()
    cv2.imwrite(str(tmp_path / "one" / "0.png"), np.zeros((H, W, 3), np.uint8))
    with pytest.raises(InputError, match="no two frames"):
        sample(tmp_path / "one", None)
