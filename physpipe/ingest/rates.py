"""What a recording's timestamps say about its frame rate, and what its user should know."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physpipe.io.video import Recording

IRREGULAR = 0.25  # of the usual interval; beyond it an interval is another interval
TICK_S = 0.0011  # WebM's clock counts milliseconds
SHORTFALL = 0.99  # edit lists hide a frame or two
WRONG_CLAIM = 0.1  # relative


def summary(
    recording: Recording, times_s: NDArray[np.float64], decoded: NDArray[np.bool_], fps: float | None
) -> dict[str, Any]:
    """Claimed and measured rate, frame and error counts, and warnings with figures."""
    measured = measured_fps(times_s)
    return {
        "claimed_fps": recording.claimed_fps,
        "measured_fps": measured,
        "frames": len(times_s),
        "decode_errors": int((~decoded).sum()),
        "warnings": _warnings(recording, times_s, decoded, measured, fps),
    }


def measured_fps(times_s: NDArray[np.float64]) -> float:
    """One over the mean of the usual intervals: neither gaps nor the clock's ticks move it; NaN for a single frame."""
    intervals = np.diff(times_s)
    return float(1 / intervals[~_irregular(intervals)].mean()) if len(intervals) else math.nan


def _irregular(intervals: NDArray[np.float64]) -> NDArray[np.bool_]:
    usual = np.median(intervals)
    return np.abs(intervals - usual) > IRREGULAR * usual + TICK_S


def _warnings(
    recording: Recording,
    times_s: NDArray[np.float64],
    decoded: NDArray[np.bool_],
    measured: float,
    fps: float | None,
) -> list[str]:
    found = [*_about_times(times_s), *_about_the_end(recording, times_s)]
    if abs(recording.claimed_fps - measured) > WRONG_CLAIM * measured and recording.source_fps is None:
        found.append(f"the header claims {recording.claimed_fps:.4g} fps, the timestamps say {measured:.4g}")
    if recording.repaired_times:
        found.append(f"{recording.repaired_times} timestamps absent, not growing or far off, set one interval on")
    if recording.pixel_aspect != 1:
        found.append(f"pixels are {recording.pixel_aspect:.4g} times as wide as high: the picture is stretched")
    if fps is not None and fps > measured * (1 + WRONG_CLAIM):
        found.append(f"{fps:.4g} fps asked of {measured:.4g}: frames repeat")
    if not decoded.all():
        found.append(f"{int((~decoded).sum())} frames could not be decoded")
    return found


def _about_times(times_s: NDArray[np.float64]) -> list[str]:
    intervals = np.diff(times_s)
    if not len(intervals):
        return []
    usual, odd = float(np.median(intervals)), _irregular(intervals)
    multiple = intervals / usual
    gaps = odd & (multiple > 1.5) & (np.abs(multiple - multiple.round()) < IRREGULAR)
    found = []
    if gaps.any():
        lost = int((multiple[gaps].round() - 1).sum())
        found.append(f"{int(gaps.sum())} gaps in the timestamps, {lost} frames were never stored")
    if (odd & ~gaps).any():
        share = 100 * (odd & ~gaps).mean()
        spread = f"{1e3 * intervals.min():.3g} to {1e3 * intervals.max():.3g} ms, usually {1e3 * usual:.3g}"
        found.append(f"variable rate: {share:.2g} % of the intervals differ ({spread})")
    return found


def _about_the_end(recording: Recording, times_s: NDArray[np.float64]) -> list[str]:
    if recording.promised_frames * SHORTFALL > len(times_s) + 2:
        return [f"the file ends early: {len(times_s)} of the {recording.promised_frames} frames its header promises"]
    interval = float(np.median(np.diff(times_s))) if len(times_s) > 1 else 0.0
    span = times_s[-1] - times_s[0] + interval
    if recording.source_fps is None and span < SHORTFALL * recording.promised_s - interval:
        return [f"the file ends early: {span:.3g} of the {recording.promised_s:.3g} s its header promises"]
    return []
