"""Doubtful spans are where the score is lowest; distances go to the nearest true object."""

import numpy as np
import pandas as pd
import pytest

from physpipe.io import tracks
from physpipe.report.spans import doubtful_spans, nearest_px


def table(clip: str, scores: list[float], lost: tuple[int, ...] = ()) -> pd.DataFrame:
    T = len(scores)
    xy = np.stack([np.arange(T, dtype=float), np.full(T, 5.0)], axis=1)[:, None]
    xy[list(lost)] = np.nan
    return tracks.rows(clip, np.arange(T) * 0.5, xy, np.array(scores)[:, None])


def test_worst_spans_come_first_and_do_not_overlap():
    track = pd.concat(
        [table("a", [0.9, 0.1, 0.1, 0.9, 0.9, 0.9]), table("b", [0.9, 0.9, 0.9, 0.9, 0.3, 0.3])], ignore_index=True
    )
    spans = doubtful_spans(track, tracks.empty(), frames=2, count=2)
    assert spans[["clip", "first", "last", "from_s"]].to_numpy().tolist() == [["a", 1, 2, 0.5], ["b", 4, 5, 2.0]]
    assert spans["score"].tolist() == pytest.approx([0.1, 0.3])
    assert spans["error_px"].isna().all()
    every = doubtful_spans(track, tracks.empty(), frames=2, count=99)
    assert not every.duplicated(["clip", "object", "first"]).any()
    assert all((mine.sort_values("first")["first"].diff().dropna() >= 2).all() for _, mine in every.groupby("clip"))


def test_lost_frames_are_counted_and_errors_averaged_over_the_rest():
    track = table("a", [0.9, 0.9, 0.2, 0.2, 0.9], lost=(2,))
    truth = tracks.rows(
        "a", np.arange(5) * 0.5, tracks.positions(table("a", [1.0] * 5), "a") + np.array([0, 3]), np.ones((5, 1))
    )
    worst = doubtful_spans(track, truth, frames=2, count=1).iloc[0]
    assert (worst["first"], worst["last"], worst["lost"]) == (2, 3, 1)
    assert worst["error_px"] == pytest.approx(3.0, abs=1e-5)


def test_clips_shorter_than_a_span_are_taken_whole():
    spans = doubtful_spans(table("a", [0.5, 0.7]), tracks.empty(), frames=8, count=3)
    assert spans[["first", "last"]].to_numpy().tolist() == [[0, 1]]


def test_nearest_ignores_numbering_and_missing_objects():
    truth = np.array([[[0.0, 0.0], [10.0, 0.0], [np.nan, np.nan]]])
    found = np.array([[[10.0, 3.0], [0.0, 4.0], [np.nan, np.nan]]])
    np.testing.assert_allclose(nearest_px(found, truth), [[3.0, 4.0, np.nan]])
    np.testing.assert_array_equal(nearest_px(found, truth[:, :0]), np.full((1, 3), np.nan))
