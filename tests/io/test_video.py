"""Recordings in every shape: order, times, failures, orientation, pixel formats."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.io import video

H, W = 48, 80


def stripes(count: int, height: int = H, width: int = W) -> list[NDArray[np.uint8]]:
    """Frames whose number shows as their grey level: 20 + 6 per frame."""
    return [np.full((height, width, 3), 20 + 6 * number, np.uint8) for number in range(count)]


def encode(
    path: Path,
    frames: Sequence[NDArray[np.uint8]],
    times_ms: Sequence[int] | None = None,
    codec: str = "libx264",
    pixels: str = "yuv420p",
    source: str = "rgb24",
    rotation: int | None = None,
    options: dict[str, str] | None = None,
) -> Path:
    """A video of `frames` at `times_ms`, default every 10 ms."""
    with av.open(path, "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=100)
        stream.height, stream.width, stream.pix_fmt = *frames[0].shape[:2], pixels
        stream.codec_context.time_base = Fraction(1, 1000)
        if rotation is not None:
            stream.set_display_rotation(rotation)
        for number, pixels_in in enumerate(frames):
            frame = av.VideoFrame.from_ndarray(pixels_in, format=source)
            frame.pts = times_ms[number] if times_ms else 10 * number
            frame.time_base = Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def read(path: Path, source_fps: float | None = None) -> tuple[video.Recording, list[video.SourceFrame]]:
    recording = video.Recording(path, source_fps)
    return recording, list(recording)


def level(frame: video.SourceFrame) -> float:
    assert frame.image is not None
    return float(video.rgb(frame.image).mean())


def damaged(path: Path, number: int) -> Path:
    """The file with the bytes of one packet overwritten."""
    with av.open(path) as container:
        packet = [packet for packet in container.demux(video=0) if packet.size][number]
        start, size = packet.pos, packet.size
    content = bytearray(path.read_bytes())
    content[start + 8 : start + size] = bytes((37 * place + 11) % 256 for place in range(size - 8))
    path.write_bytes(content)
    return path


def refusal(path: Path, source_fps: float | None = None) -> str:
    with pytest.raises(InputError) as caught:
        read(path, source_fps)
    assert path.name in caught.value.where
    return str(caught.value)


@pytest.mark.parametrize("name", ["film.mp4", "film.mkv"])
def test_frames_come_in_order_at_the_streams_own_times(tmp_path: Path, name: str) -> None:
    times_ms = [0, 10, 20, 50, 51, 90, 100, 130, 135, 140, 180, 200]  # variable, and reordered by the codec's B-frames
    recording, frames = read(encode(tmp_path / name, stripes(12), times_ms))
    assert [frame.number for frame in frames] == list(range(12))
    assert np.array([frame.time_s for frame in frames]) == pytest.approx(np.array(times_ms) / 1000, abs=1e-4)
    assert np.diff([level(frame) for frame in frames]).min() > 3  # grey levels; 6 were drawn
    assert recording.repaired_times == 0


def test_source_fps_replaces_the_timestamps(tmp_path: Path) -> None:
    _, frames = read(encode(tmp_path / "film.mp4", stripes(5), [0, 1, 5, 6, 30]), source_fps=4.0)
    assert [frame.time_s for frame in frames] == [0, 0.25, 0.5, 0.75, 1.0]


@pytest.mark.parametrize(
    ("name", "codec", "pixels"), [("film.mkv", "libx264", "yuv420p"), ("film.avi", "mjpeg", "yuvj420p")]
)
def test_a_damaged_frame_keeps_its_number_and_time(tmp_path: Path, name: str, codec: str, pixels: str) -> None:
    options = {"bf": "0"} if codec == "libx264" else None
    noise = np.random.default_rng(1).integers(0, 255, (30, H, W, 3)).astype(np.uint8)
    path = encode(tmp_path / name, list(noise), codec=codec, pixels=pixels, options=options)
    whole = [frame.time_s for frame in read(path)[1]]
    frames = read(damaged(path, 17))[1]
    assert [frame.time_s for frame in frames] == whole
    assert [frame.number for frame in frames] == list(range(30))
    lost = [frame.time_s for frame in frames if frame.image is None]
    assert len(lost) == 1
    assert lost[0] > whole[10]


def test_a_file_cut_in_the_middle_gives_what_it_still_holds(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 255, (60, H, W, 3)).astype(np.uint8)
    path = encode(tmp_path / "film.mp4", list(noise), options={"movflags": "faststart"})
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    recording, frames = read(path)
    assert recording.promised_frames == 60
    assert 20 < sum(frame.image is not None for frame in frames) < 40


def test_what_is_no_video_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "empty.mp4").touch()
    assert "0 bytes" in refusal(tmp_path / "empty.mp4")
    (tmp_path / "text.mp4").write_text("these are words\n" * 99)
    assert "not a readable video" in refusal(tmp_path / "text.mp4")
    with av.open(tmp_path / "sound.wav", "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000, layout="mono")
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), layout="mono")
        frame.sample_rate = 8000
        container.mux(stream.encode(frame))
    assert "no video stream" in refusal(tmp_path / "sound.wav")


def test_absent_backward_and_far_off_timestamps_become_one_interval_more(monkeypatch: pytest.MonkeyPatch) -> None:
    stamps = [0.0, 0.1, None, 0.3, 0.25, 0.5, 1e6, 0.7]
    recording = video.Recording(Path("film.mp4"), None)
    monkeypatch.setattr(recording, "_from_video", lambda: iter([(stamp, None) for stamp in stamps]))
    assert [frame.time_s for frame in recording] == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    assert recording.repaired_times == 3


def test_frames_without_any_time_need_source_fps(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = video.Recording(Path("film.h264"), None)
    monkeypatch.setattr(recording, "_from_video", lambda: iter([(None, None)] * 3))
    with pytest.raises(InputError, match="source_fps"):
        list(recording)


@pytest.mark.parametrize("rotation", [0, 90, 180, -90])
def test_rotated_film_comes_upright_as_in_other_players(tmp_path: Path, rotation: int) -> None:
    corner = np.full((H, W, 3), 30, np.uint8)
    corner[: H // 2, : W // 2] = (200, 60, 60)
    path = encode(tmp_path / "film.mp4", [corner] * 3, rotation=rotation)
    image = read(path)[1][0].image
    assert image is not None
    other = cv2.VideoCapture(str(path)).read()[1][..., ::-1]
    ours = video.rgb(image)
    assert ours.shape == other.shape
    assert np.abs(ours.astype(int) - other).max() <= 4  # grey levels: two colour conversions


@pytest.mark.parametrize(
    ("pixels", "source"),
    [("gray", "gray"), ("gray10le", "gray"), ("gray16le", "gray"), ("yuv444p10le", "rgb24"), ("yuv420p", "rgb24")],
)
def test_depths_grey_and_odd_sizes_give_the_same_levels(tmp_path: Path, pixels: str, source: str) -> None:
    frames = [each if source == "rgb24" else each[..., 0] for each in stripes(3, 33, 27)]
    found = read(encode(tmp_path / "film.mkv", frames, codec="ffv1", pixels=pixels, source=source))[1]
    assert [level(frame) for frame in found] == pytest.approx([20, 26, 32], abs=1.5)  # grey levels
    assert found[0].image is not None
    assert video.rgb(found[0].image).shape == (33, 27, 3)


def test_what_is_transparent_is_black(tmp_path: Path) -> None:
    rgba = np.full((H, W, 4), 200, np.uint8)
    rgba[..., 3] = 255
    rgba[:, W // 2 :, 3] = 0
    (tmp_path / "burst").mkdir()
    cv2.imwrite(str(tmp_path / "burst" / "0.png"), rgba)
    image = read(tmp_path / "burst", source_fps=1.0)[1][0].image
    assert image is not None
    assert video.rgb(image)[:, : W // 2].min() == 200
    assert video.rgb(image)[:, W // 2 :].max() == 0


def test_images_are_a_recording_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    folder = tmp_path / "burst"
    folder.mkdir()
    for number, each in enumerate(stripes(12)):
        cv2.imwrite(str(folder / f"shot{number}.png"), each.astype(np.uint16) * 257)
    (folder / "shot5.png").write_bytes(b"broken")
    (folder / "notes.txt").write_text("not an image")
    frames = read(folder, source_fps=20.0)[1]
    assert [frame.image is None for frame in frames] == [number == 5 for number in range(12)]
    assert frames[11].time_s == pytest.approx(0.55)
    assert [level(frame) for frame in frames[9:]] == pytest.approx([74, 80, 86], abs=1)
    assert "source_fps" in refusal(folder)
