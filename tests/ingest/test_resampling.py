"""Resampling by timestamp: the nearest frame, by brute force; failures and holes keep their rows and say so."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from physpipe.ingest import resampling
from physpipe.io.video import SourceFrame


def resample(
    times_s: ArrayLike, fps: float | None, lost: tuple[int, ...] = (), max_gap_s: float = 1e9
) -> tuple[pd.DataFrame, list[int]]:
    """The rows, and the numbers of the frames whose pictures are kept."""
    times = np.asarray(times_s, float)
    frames = [SourceFrame(i, t, None if i in lost else "image") for i, t in enumerate(times)]  # type: ignore[arg-type]
    counted = list(resampling.nearest(frames, fps))
    assert [frame.number for frame, _ in counted] == list(range(len(times)))
    counts = np.array([count for _, count in counted])
    decoded = np.array([frame.image is not None for frame in frames])
    return resampling.rows(times, decoded, counts, fps, max_gap_s), np.flatnonzero(decoded & (counts > 0)).tolist()


@pytest.mark.parametrize("start_s", [0.0, -0.3, 1234.5])
def test_240_to_80_takes_every_third_frame_exactly(start_s: float) -> None:
    rows, kept = resample(start_s + np.arange(300) / 240, 80.0)
    assert rows["source_frame"].tolist() == list(range(0, 300, 3)) == kept
    assert rows["picture"].tolist() == list(range(100))
    np.testing.assert_allclose(rows["target_s"], start_s + np.arange(100) / 80, atol=1e-9)
    np.testing.assert_allclose(rows["source_time_s"], rows["target_s"], atol=1e-9)
    assert set(rows["status"]) == {"ok"}


def test_a_clock_of_milliseconds_does_not_disturb_240_to_80() -> None:
    rows, _ = resample(np.round(np.arange(300) / 0.240) / 1000, 80.0)
    assert rows["source_frame"].tolist() == list(range(0, 300, 3))


@given(
    st.lists(st.integers(1, 120), min_size=1, max_size=40),
    st.sampled_from([5.0, 10.0, 29.97, 80.0, 240.0]),
)
def test_every_target_time_has_the_nearest_frame(intervals_ms: list[int], fps: float) -> None:
    times = np.concatenate([[0], np.cumsum(intervals_ms)]) / 1000
    rows, _ = resample(times, fps)
    targets = np.arange(int(np.floor(times[-1] * fps + 1e-6)) + 1) / fps
    np.testing.assert_allclose(rows["target_s"], targets, atol=1e-9)
    best = np.abs(targets[:, None] - times).min(axis=1)
    np.testing.assert_allclose(np.abs(rows["source_time_s"] - targets), best, atol=2e-6 / fps)
    assert rows["source_frame"].is_monotonic_increasing


def test_without_fps_every_frame_stays_at_its_own_time() -> None:
    times = [0.0, 0.1, 0.15, 0.4, 0.41]
    rows, kept = resample(times, None)
    assert kept == rows["source_frame"].tolist() == [0, 1, 2, 3, 4]
    assert rows["target_s"].tolist() == times


def test_a_lost_frame_repeats_the_one_before_and_says_so() -> None:
    for fps, wanted in ((None, [0, 1, 2, 2, 3, 4]), (10.0, [0, 1, 2, 2, 3, 4])):
        rows, kept = resample(np.arange(6) / 10, fps, lost=(3,))
        assert kept == [0, 1, 2, 4, 5]
        assert rows["source_frame"].tolist() == [0, 1, 2, 3, 4, 5]
        assert rows["status"].tolist() == ["ok"] * 3 + ["decode_error"] + ["ok"] * 2
        assert rows["picture"].tolist() == wanted


def test_lost_frames_at_either_end_have_no_row() -> None:
    for fps in (None, 10.0):
        rows, kept = resample(np.arange(8) / 10, fps, lost=(0, 1, 7))
        assert kept == rows["source_frame"].tolist() == [2, 3, 4, 5, 6]
        assert rows["picture"].tolist() == [0, 1, 2, 3, 4]


def test_times_that_were_not_filmed_are_missing() -> None:
    times = np.delete(np.arange(40) / 40, np.arange(10, 18))  # 8 of 40 frames never stored
    rows, _ = resample(times, 40.0)
    assert len(rows) == 40
    assert rows.index[rows["status"] == "missing"].tolist() == list(range(11, 17))  # beyond 1.5 intervals of any frame
    assert set(rows["segment"]) == {0}


def test_a_long_hole_ends_a_segment_and_has_no_rows() -> None:
    times = np.concatenate([np.arange(10), np.arange(1000, 1010)]) / 10
    for fps in (None, 10.0):
        rows, _ = resample(times, fps, max_gap_s=0.5)
        assert rows["source_frame"].tolist() == list(range(20))
        assert rows["segment"].tolist() == [0] * 10 + [1] * 10
        assert set(rows["status"]) == {"ok"}


def test_a_long_run_of_lost_frames_is_a_hole_too() -> None:
    for fps in (None, 10.0):
        rows, _ = resample(np.arange(30) / 10, fps, lost=tuple(range(10, 20)), max_gap_s=0.5)
        assert rows["source_frame"].tolist() == [*range(10), *range(20, 30)]
        assert rows["segment"].tolist() == [0] * 10 + [1] * 10


def test_a_single_frame_is_a_row() -> None:
    for fps in (None, 80.0):
        assert resample([3.0], fps)[0]["source_frame"].tolist() == [0]
