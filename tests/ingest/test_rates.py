"""What timestamps say: the measured rate, and warnings with figures where a user should know."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from physpipe.ingest import rates
from physpipe.io.video import Recording


def summary(times_s: ArrayLike, fps: float | None = None, **header: Any) -> dict[str, Any]:
    times = np.asarray(times_s, float)
    recording = Recording(Path("a.mp4"), header.pop("source_fps", None))
    recording.claimed_fps = rates.measured_fps(times)
    vars(recording).update(header)
    return rates.summary(recording, times, np.ones(len(times), bool), fps)


@pytest.mark.parametrize("fps", [10.9, 23.976, 29.97, 30.0, 60.0, 240.0])
@pytest.mark.parametrize("clock", [1e-3, 1 / 90000])
def test_a_steady_rate_is_measured_through_the_clocks_ticks_without_a_warning(fps: float, clock: float) -> None:
    found = summary(np.round(np.arange(200) / fps / clock) * clock)
    assert found["measured_fps"] == pytest.approx(fps, rel=2e-3)
    assert found["warnings"] == []
    assert found["frames"] == 200


def test_gaps_do_not_move_the_rate_and_are_counted() -> None:
    found = summary(np.delete(np.arange(200) / 30, [50, 51, 120]))
    assert found["measured_fps"] == pytest.approx(30)
    assert found["warnings"] == ["2 gaps in the timestamps, 3 frames were never stored"]


def test_a_variable_rate_is_told_with_figures() -> None:
    intervals = np.tile([20, 33, 33, 33, 50], 40) / 1000
    (warning,) = summary(np.cumsum(intervals))["warnings"]
    assert "variable rate: 40 % of the intervals differ (20 to 50 ms, usually 33)" in warning


def test_a_header_that_lies_is_told_unless_the_user_knows() -> None:
    times = np.arange(100) / 10.9
    assert summary(times, claimed_fps=250.0)["warnings"] == ["the header claims 250 fps, the timestamps say 10.9"]
    assert summary(times, claimed_fps=250.0, source_fps=10.9)["warnings"] == []


def test_the_other_warnings() -> None:
    times = np.arange(100) / 30
    assert "frames repeat" in summary(times, fps=80.0)["warnings"][0]
    assert "100 of the 200 frames" in summary(times, promised_frames=200)["warnings"][0]
    assert "3.33 of the 8 s" in summary(times, promised_s=8.0)["warnings"][0]
    assert "2 timestamps" in summary(times, repaired_times=2)["warnings"][0]
    assert "1.333 times as wide" in summary(times, pixel_aspect=4 / 3)["warnings"][0]


def test_undecodable_frames_are_counted() -> None:
    times = np.arange(100) / 30
    found = rates.summary(Recording(Path("a.mp4"), 30.0), times, times > 0.05, None)
    assert found["decode_errors"] == 2
    assert "2 frames could not be decoded" in found["warnings"]


def test_a_single_frame_has_no_rate() -> None:
    assert np.isnan(summary([0.0])["measured_fps"])
