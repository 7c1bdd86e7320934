"""The player is given the right frames, and marks that are those of the tables."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from physpipe.io import tracks
from physpipe.report import playing
from physpipe.report.brushes import CHI2_90
from physpipe.report.overlays import marks_of
from physpipe.report.playing import Excerpt, FilmParams, ellipses, excerpts, shown_clips

PARAMS = FilmParams(clips=2, frames_at_most=100, fps_at_most=30.0, quality=80)


def spans(*rows: tuple[str, int, int]) -> pd.DataFrame:
    return pd.DataFrame(rows, columns=["clip", "first", "last"])


def test_clips_are_spread_over_the_test_split(bowls):
    assert shown_clips(bowls, 9) == ["bowls_003", "bowls_004"]
    assert shown_clips(bowls, 1) == ["bowls_003"]


def test_clips_without_a_track_are_left_out(bowls):
    track = bowls.track
    assert shown_clips(replace(bowls, track=track[track["clip"] != "bowls_003"]), 9) == ["bowls_004"]
    assert shown_clips(replace(bowls, track=tracks.empty()), 9) == []


def test_every_span_begins_in_some_excerpt(bowls):
    asked = spans(("bowls_000", 10, 13), ("bowls_000", 14, 17), ("bowls_003", 2, 5), ("bowls_001", 22, 23))
    chosen = excerpts(bowls, ["bowls_003"], asked, 8)
    assert chosen == [
        Excerpt("bowls_003", 0, 7),
        Excerpt("bowls_000", 8, 15),
        Excerpt("bowls_001", 16, 23),
    ]


def test_short_clips_are_taken_whole(bowls, project):
    chosen = excerpts(bowls, ["bowls_003"], spans(("bowls_000", 20, 23)), 100)
    assert chosen == [Excerpt(clip, 0, project.world.frames - 1) for clip in ("bowls_003", "bowls_000")]


def test_marks_and_errors_are_those_of_the_tables(bowls, project):
    world = project.world
    shown = playing.film(bowls, [Excerpt("bowls_003", 2, 11)], spans(("bowls_000", 10, 13)), "probnet", PARAMS)
    (scene,) = json.loads(json.dumps(shown, allow_nan=False))["scenes"]
    marks = marks_of(bowls, "bowls_003")
    np.testing.assert_allclose(scene["truth"], marks.truth[2:12], atol=0.006)  # px, rounded to hundredths
    np.testing.assert_allclose(scene["track"], marks.track[2:12], atol=0.006)
    forecast = scene["forecasts"]["dispnet"]
    np.testing.assert_allclose(forecast["xy"], marks.forecast[4:12], atol=0.006)
    assert (forecast["seen"], forecast["start"]) == (world.seen - 1, 2)
    assert len(forecast["ellipse"]) == len(forecast["off_px"]) == 8
    assert shown["predictors"] == ["probnet", "dispnet", "persistence", "linear", "quadratic"]
    assert set(scene["forecasts"]) == set(shown["predictors"])
    np.testing.assert_allclose(scene["track_px"], np.full((10, 1), world.off_px), atol=0.006)
    np.testing.assert_allclose(np.diff(scene["times_s"]), 1 / world.rate, atol=1e-4)  # seconds
    assert (scene["first"], scene["total"]) == (2, world.frames)
    assert scene["size"] == [world.width, world.height]
    assert shown["fps"] == pytest.approx(world.rate, rel=1e-4)
    assert (shown["fps_at_first"], shown["horizon"]) == (30, world.horizon)


def test_what_is_lost_or_doubtful_or_broken_is_said(film, monkeypatch):
    track = film.track.copy()
    mine = track["clip"] == "film_003"
    track.loc[mine & (track["object"] == 0) & (track["frame"] == 5), ["x", "y", "visible", "status"]] = (
        np.nan,
        np.nan,
        False,
        "lost",
    )
    track.loc[mine & (track["object"] == 1) & (track["frame"] == 6), "status"] = tracks.AMBIGUOUS
    rows = film.clips.rows("film_003").copy()
    rows.loc[rows["frame"] == 7, "status"] = "missing"
    monkeypatch.setattr(film.clips, "rows", lambda clip: rows)
    (scene,) = playing.film(replace(film, track=track), [Excerpt("film_003", 0, 9)], spans(), "dispnet", PARAMS)[
        "scenes"
    ]
    assert scene["state"][4:8] == ["tt", "lt", "ta", "tt"]
    assert scene["track"][5][0] is None
    assert scene["truth"] == [[]] * 10
    assert scene["track_px"][0] == [None, None]
    assert scene["faults"] == {"7": "missing"}


def test_a_forecast_without_covariances_has_no_ellipse(bowls):
    (scene,) = playing.film(bowls, [Excerpt("bowls_003", 0, 9)], spans(), "dispnet", PARAMS)["scenes"]
    without = {name for name, forecast in scene["forecasts"].items() if forecast["ellipse"] is None}
    assert without == {"persistence", "linear", "quadratic"}


def test_each_forecast_is_its_own_predictors(bowls, project):
    excerpts = [Excerpt("bowls_003", 0, 9), Excerpt("bowls_003", 8, 12), Excerpt("bowls_000", 0, 9)]
    whole, late, training = playing.film(bowls, excerpts, spans(), "dispnet", PARAMS)["scenes"]
    for name, table in bowls.forecasts.items():
        xy = table[table["clip"] == "bowls_003"].set_index("frame").loc[:, ["x", "y"]]
        np.testing.assert_allclose(np.array(whole["forecasts"][name]["xy"])[:, 0], xy.loc[4:9], atol=0.006)
        np.testing.assert_allclose(np.array(late["forecasts"][name]["xy"])[:, 0], xy.loc[8:12], atol=0.006)
        assert (late["forecasts"][name]["seen"], late["forecasts"][name]["start"]) == (project.world.seen - 1, 0)
    assert training["forecasts"] == {}  # it was learned from


@pytest.mark.parametrize("angle", [0.0, 0.5, 2.0])
def test_ellipses_have_the_covariances_axes(angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    found = ellipses(turn @ np.diag([9.0, 4.0]) @ turn.T)
    np.testing.assert_allclose(found[:2], np.sqrt(CHI2_90) * np.array([3.0, 2.0]))
    assert np.sin(found[2] - angle) == pytest.approx(0, abs=1e-6)  # an axis has no direction


def test_nothing_known_gives_no_ellipse():
    unknown = np.full((3, 2, 2, 2), np.nan)
    assert np.isnan(ellipses(unknown)).all()
