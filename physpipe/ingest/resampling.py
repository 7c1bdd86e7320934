"""Another frame rate by timestamps: every target time takes the nearest source frame; nothing is blended."""

import math
from collections.abc import Iterable, Iterator

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io.video import SourceFrame

ROUNDING = 1e-6  # of a target interval: what floating point may lose
FAR = 1.5  # source intervals: a target time that far from any source frame was not filmed


def nearest(frames: Iterable[SourceFrame], fps: float | None) -> Iterator[tuple[SourceFrame, int]]:
    """Each source frame with the number of target times that it is the nearest to.

    Target times are k / `fps` after the first decoded frame; `fps` None makes every frame from
    there on its own target. Nothing before the first decoded frame is a target.
    """
    before, start_s, done = None, math.nan, 0
    for frame in frames:
        if before is None and frame.image is None:
            yield frame, 0
            continue
        if before is None:
            start_s = frame.time_s
        else:
            total = done + 1 if fps is None else _targets_until((before.time_s + frame.time_s) / 2 - start_s, fps)
            yield before, total - done
            done = total
        before = frame
    if before is not None:
        yield before, 1 if fps is None else _targets_until(before.time_s - start_s, fps) - done


def _targets_until(span_s: float, fps: float) -> int:
    return math.floor(span_s * fps + ROUNDING) + 1


def rows(
    times_s: NDArray[np.float64],
    decoded: NDArray[np.bool_],
    counts: NDArray[np.int64],
    fps: float | None,
    max_gap_s: float,
) -> pd.DataFrame:
    """A row for every target time, from the (N,) source times, whether each was decoded, and `nearest`'s counts.

    Columns: target_s, source_frame, source_time_s, picture (index among the kept and decoded
    frames; the one before where there is none), status, segment (grows at each hole longer than
    `max_gap_s`, whose rows are left out).
    """
    source = np.repeat(np.arange(len(times_s)), counts)
    seen_s = times_s[decoded]
    target_s = times_s[source] if fps is None else seen_s[0] + np.arange(len(source)) / fps
    picture = np.cumsum(decoded & (counts > 0))[source] - 1
    far = np.abs(target_s - times_s[source]) > FAR * interval_s(times_s)
    status = np.select([far, ~decoded[source]], ["missing", "decode_error"], "ok")
    table = pd.DataFrame(
        {
            "target_s": target_s,
            "source_frame": source.astype(np.int32),
            "source_time_s": times_s[source],
            "picture": picture,
            "status": status.astype(object),
        }
    )
    return _without_holes(table, seen_s, interval_s(times_s), max_gap_s)


def interval_s(times_s: NDArray[np.float64]) -> float:
    """The usual time between two frames; NaN for fewer than two."""
    return float(np.median(np.diff(times_s))) if len(times_s) > 1 else math.nan


def _without_holes(table: pd.DataFrame, seen_s: NDArray[np.float64], interval: float, max_gap_s: float) -> pd.DataFrame:
    """Only what lies near the decoded frames at `seen_s`, or between two of them that are not too far apart."""
    target = table["target_s"].to_numpy()
    holes = np.flatnonzero(np.diff(seen_s) > max_gap_s)
    lost = (target < seen_s[0]) | (target > seen_s[-1] + interval / 2)
    for hole in holes:
        lost |= (target > seen_s[hole] + interval / 2) & (target < seen_s[hole + 1] - interval / 2)
    middles = (seen_s[holes] + seen_s[holes + 1]) / 2
    return table.assign(segment=np.searchsorted(middles, target))[~lost].reset_index(drop=True)
