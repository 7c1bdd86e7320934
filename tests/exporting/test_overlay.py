"""Overlay films decode to the film at its own times, with marks where the objects are."""

from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pandas as pd
import pytest
from PIL import Image
from worlds import encoded

from physpipe.core.errors import InputError
from physpipe.exporting import view
from physpipe.exporting.overlay import Tables, write_overlay
from physpipe.io import clips as clip_files
from physpipe.io import forecasts, tracks
from physpipe.report import colours
from physpipe.report.overlays import marks_of


def frames_of(path: Path) -> tuple[list[np.ndarray], np.ndarray, av.VideoFrame]:
    """Pictures, times and a frame."""
    with av.open(path) as container:
        frames = list(container.decode(video=0))
    return [each.to_ndarray(format="rgb24") for each in frames], np.array([each.time for each in frames]), frames[0]


def tables(balls, forecast: pd.DataFrame | None = None) -> Tables:
    return Tables(tracks.empty(), balls.table, forecasts.empty() if forecast is None else forecast)


def middle_of(picture: np.ndarray, colour: str) -> np.ndarray:
    """(x, y) of the largest patch of `colour`, that of a dot rather than of a number."""
    near = (np.abs(picture.astype(int) - colours.rgb(colour)) < 60).all(axis=2)
    y, x = np.nonzero(near)
    middle = np.median([x, y], axis=1)
    inside = np.hypot(x - middle[0], y - middle[1]) < 7
    return np.array([x[inside].mean(), y[inside].mean()])


@pytest.mark.parametrize("slower", [1.0, 4.0])
def test_it_plays_at_the_clip_s_own_times(balls, tmp_path, slower):
    on = view.of_clip(balls.clips, "film_01", 7)
    write_overlay(tmp_path / "a.mp4", balls.clips, "film_01", tables(balls), on, 5, slower)
    pictures, times_s, frame = frames_of(tmp_path / "a.mp4")
    np.testing.assert_allclose(times_s, balls.clips.times_s("film_01") * slower, atol=1e-4)
    assert (frame.width, frame.height, frame.format.name) == (210, 224, "yuv420p")


def test_a_moving_picture_has_the_same_frames_at_the_clip_s_own_times_and_plays_for_ever(balls, tmp_path):
    for suffix in ("mp4", "webp"):
        on = view.of_clip(balls.clips, "film_01", 7)
        write_overlay(tmp_path / f"a.{suffix}", balls.clips, "film_01", tables(balls), on, 5, 2.0)
    film = frames_of(tmp_path / "a.mp4")[0]
    with Image.open(tmp_path / "a.webp") as moving:
        assert (moving.format, moving.n_frames, moving.info["loop"]) == ("WEBP", len(film), 0)
        shown_s = []
        for t in range(moving.n_frames):
            moving.seek(t)
            apart = np.abs(np.asarray(moving.convert("RGB"), int) - film[t])
            assert apart.mean() < 3  # grey levels; two lossy codecs
            shown_s.append(moving.info["duration"] / 1000)
    steps_s = np.diff(balls.clips.times_s("film_01")) * 2.0
    np.testing.assert_allclose(shown_s[:-1], steps_s, atol=0.0011)  # WebP counts milliseconds


def test_a_wavering_rate_is_kept(balls, tmp_path):
    table = balls.clips.table.copy()
    times_s = np.cumsum(np.tile([0.02, 0.05], 10)) - 0.02
    table.loc[table["clip"] == "film_00", "time_s"] = times_s
    folder = tmp_path / "clips"
    folder.mkdir()
    for name in balls.clips.names():
        np.save(folder / f"{name}.npy", balls.clips.frames(name))
    table.to_parquet(folder / clip_files.TABLE)
    clips = clip_files.ClipSet(folder)
    write_overlay(tmp_path / "a.mp4", clips, "film_00", tables(balls), view.of_clip(clips, "film_00", 7), 5, 1.0)
    np.testing.assert_allclose(frames_of(tmp_path / "a.mp4")[1], times_s, atol=1e-4)


def test_odd_sizes_are_padded(balls, tmp_path):
    on = view.of_clip(balls.clips, "film_01", 1)
    odd = replace(on, pictures=(picture[:31, :29] for picture in on.pictures))
    write_overlay(tmp_path / "a.mp4", balls.clips, "film_01", tables(balls), odd, 5, 1.0)
    frame = frames_of(tmp_path / "a.mp4")[2]
    assert (frame.width, frame.height) == (30, 32)


def test_dots_lie_on_the_objects_of_the_film(balls, tmp_path):
    on = view.of_film(balls.clips, "film_01", balls.raw)
    write_overlay(tmp_path / "a.mp4", balls.clips, "film_01", tables(balls), on, 0, 1.0)
    pictures, _, frame = frames_of(tmp_path / "a.mp4")
    assert (frame.width, frame.height) == (90, 60)
    for t in (0, 19):
        np.testing.assert_allclose(middle_of(pictures[t], colours.of_object(0)), balls.source_xy[1, t, 0], atol=2)


def test_the_film_s_frames_are_those_of_the_clip(balls):
    shown = np.stack(list(view.of_film(balls.clips, "film_01", balls.raw).pictures))
    whole = [picture for _, picture in view._upright(balls.raw / "film.mkv")]
    np.testing.assert_array_equal(shown, np.stack(whole[40:80:2]))


def test_large_film_is_reduced_and_marks_with_it(balls, monkeypatch):
    monkeypatch.setattr(view, "LONGEST_PX", 45)
    on = view.of_film(balls.clips, "film_00", balls.raw)
    assert next(iter(on.pictures)).shape == (30, 45, 3)
    clip_xy = balls.clips.geometry("film_00").to_clip(balls.source_xy[0])
    np.testing.assert_allclose(on.place.to_source(clip_xy), (balls.source_xy[0] + 0.5) / 2 - 0.5, atol=1e-9)  # pixels


def test_forecasts_bring_ellipses_of_the_right_size(balls):
    clip_xy = balls.clips.geometry("film_00").to_clip(balls.source_xy[0])
    cov = np.broadcast_to(np.array([[1.0, 0.2], [0.2, 2.0]]), (16, 2, 2, 2))
    forecast = forecasts.rows("film_00", 4, clip_xy[4:], cov)
    marks = view.of_film(balls.clips, "film_00", balls.raw).placed(marks_of(tables(balls, forecast), "film_00"))
    np.testing.assert_allclose(marks.forecast[4:], balls.source_xy[0, 4:], atol=1e-3)
    np.testing.assert_allclose(marks.covariance[10, 0], [[4.0, 0.6], [0.6, 4.5]], rtol=1e-5)  # square film pixels
    assert np.isnan(marks.covariance[:4]).all()


def test_forecast_and_numbers_are_drawn(balls, tmp_path):
    clip_xy = balls.clips.geometry("film_00").to_clip(balls.source_xy[0])
    far = forecasts.rows("film_00", 4, clip_xy[4:] + np.array([6.0, 0]))
    films = []
    for number, drawn in enumerate((tables(balls), tables(balls, far))):
        on = view.of_clip(balls.clips, "film_00", 8)
        write_overlay(tmp_path / f"{number}.mp4", balls.clips, "film_00", drawn, on, 5, 1.0)
        films.append(frames_of(tmp_path / f"{number}.mp4")[0])
    apart = [np.abs(one.astype(int) - two).max(axis=2) > 80 for one, two in zip(*films, strict=True)]
    assert apart[3].sum() < 20  # pixels; seen, not forecast
    assert apart[15].sum() > 60


def test_film_that_is_gone_or_another_is_refused(balls, tmp_path):
    with pytest.raises(InputError, match="no such film"):
        view.of_film(balls.clips, "film_00", tmp_path)
    encoded(tmp_path / "film.mkv", [np.zeros((60, 90, 3), np.uint8)] * 5, np.arange(5) / 100)
    with pytest.raises(InputError, match="ends before frame 6"):
        list(view.of_film(balls.clips, "film_00", tmp_path).pictures)
