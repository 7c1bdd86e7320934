"""Overlay films decode to what went in."""

import av
import numpy as np
import pytest

from physpipe.report.film import FilmParams, _even, shown_clips, write_film


def read(path):
    with av.open(path) as container:
        stream = container.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        return stream.codec_context, float(stream.average_rate), frames


def write(path, evidence, upscale=3, **changes):
    params = FilmParams(**{"clips": 2, "fps_at_most": 30.0, "kilobytes": 900, **changes})
    write_film(path, evidence, "dispnet", upscale, 8, params)
    return read(path)


@pytest.mark.parametrize("name", ["bowls", "film"])
@pytest.mark.parametrize("upscale", [1, 3])
def test_film_holds_every_frame_of_its_clips(name, upscale, project, tmp_path):
    codec, fps, frames = write(tmp_path / "film.mp4", project.evidence(name), upscale)
    world = project.world
    assert len(frames) == 2 * world.frames
    assert (codec.codec.name, codec.pix_fmt) == ("h264", "yuv420p")
    assert (codec.width, codec.height) == (upscale * world.width, upscale * world.height + 48)  # three lines of caption
    assert fps == pytest.approx(30, abs=0.01)  # filmed at 60


def test_slow_film_plays_at_its_own_rate(bowls, project, tmp_path):
    _, fps, _ = write(tmp_path / "film.mp4", bowls, fps_at_most=100.0)
    assert fps == pytest.approx(project.world.rate, abs=0.01)


def test_film_shows_the_clips_pictures(bowls, project, tmp_path):
    _, _, frames = write(tmp_path / "film.mp4", bowls)
    H, W = project.world.height, project.world.width
    shown = frames[0][48 : 48 + 3 * H, : 3 * W].reshape(H, 3, W, 3, 3)  # below the three lines of the caption
    clip = bowls.clips.frames("bowls_003")[0].astype(float)
    away = np.abs(shown.mean(axis=(1, 3)) - clip).mean(axis=2)
    assert np.median(away) < 12  # grey levels; marks cover few pixels, the codec blurs noise


def test_size_is_kept_and_bytes_repeat(bowls, tmp_path):
    write(tmp_path / "small.mp4", bowls, kilobytes=20)
    assert (tmp_path / "small.mp4").stat().st_size < 30_000
    for _ in range(10):
        write(tmp_path / "again.mp4", bowls, kilobytes=20)
        assert (tmp_path / "small.mp4").read_bytes() == (tmp_path / "again.mp4").read_bytes()


def test_clips_are_spread_over_the_test_split(bowls):
    assert shown_clips(bowls, 9) == ["bowls_003", "bowls_004"]
    assert shown_clips(bowls, 1) == ["bowls_003"]


def test_odd_sizes_get_a_black_edge():
    picture = np.full((5, 7, 3), 9, np.uint8)
    even = _even(picture)
    assert even.shape == (6, 8, 3)
    assert (even[:5, :7] == 9).all()
    assert even.sum() == picture.sum()
