"""Where a track is least sure of itself, and how far marks lie from the truth."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io import tracks

COLUMNS = ["clip", "object", "first", "last", "from_s", "score", "lost", "error_px"]


def doubtful_spans(track: pd.DataFrame, truth: pd.DataFrame, frames: int, count: int) -> pd.DataFrame:
    """The `count` stretches of `frames` frames with the lowest mean score, worst first, none overlapping another.

    Columns COLUMNS: `lost` counts frames without a position; `error_px` is the mean distance to the nearest
    true object, NaN without truth.
    """
    if track.empty:
        return pd.DataFrame(columns=COLUMNS)
    length = int(min(frames, track.groupby(["clip", "object"]).size().min()))
    spans = _windows(track.assign(error_px=_errors(track, truth)), length)
    chosen: list[pd.Series] = []
    while len(chosen) < count and len(spans):
        worst = spans.iloc[0]
        chosen.append(worst)
        same = (spans["clip"] == worst["clip"]) & (spans["object"] == worst["object"])
        spans = spans[~(same & ((spans["last"] - worst["last"]).abs() < length))]
    return pd.DataFrame(chosen, columns=COLUMNS)


def nearest_px(xy: NDArray[np.floating], truth: NDArray[np.floating]) -> NDArray[np.float64]:
    """(..., K) distances of `xy` (..., K, 2) to the nearest of `truth` (..., M, 2); NaN where either is missing.

    The nearest, since a tracker that nobody taught numbers the objects as it likes.
    """
    apart = np.linalg.norm(xy[..., :, None, :] - truth[..., None, :, :], axis=-1)
    nearest = np.where(np.isnan(apart), np.inf, apart).min(axis=-1, initial=np.inf)
    return np.where(np.isinf(nearest), np.nan, nearest)


def _errors(track: pd.DataFrame, truth: pd.DataFrame) -> NDArray[np.float64]:
    true, found = tracks.by_clip(truth), tracks.by_clip(track)
    parts = [
        nearest_px(xy, true[clip]).T.ravel() if clip in true else np.full(xy.shape[0] * xy.shape[1], np.nan)
        for clip, xy in found.items()
    ]
    return np.concatenate(parts)


def _windows(track: pd.DataFrame, length: int) -> pd.DataFrame:
    """Every stretch of `length` frames, lowest mean score first."""
    groups = track.assign(lost=~track["visible"]).groupby(["clip", "object"], sort=False)
    rolling = groups[["score", "lost"]].rolling(length).mean().reset_index(level=[0, 1], drop=True)
    errors = groups["error_px"].rolling(length, min_periods=1).mean().reset_index(level=[0, 1], drop=True)
    spans = pd.DataFrame(
        {
            "clip": track["clip"],
            "object": track["object"],
            "first": track["frame"] - length + 1,
            "last": track["frame"],
            "from_s": groups["time_s"].shift(length - 1),
            "score": rolling["score"],
            "lost": (rolling["lost"] * length).round(),
            "error_px": errors,
        }
    )
    return spans.dropna(subset="score").sort_values("score", kind="stable").astype({"lost": int})
