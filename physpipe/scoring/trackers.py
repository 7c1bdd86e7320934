"""Figures per tracker from track tables and the truth, test split only."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.ball import BallParams
from physpipe.core.params import Section
from physpipe.core.progress import progress
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.metrics import identity
from physpipe.metrics import trackers as metrics
from physpipe.metrics.identity import Tracked
from physpipe.metrics.trackers import OtherMotionParams
from physpipe.scoring.tracker_cases import Case, annotated_cases, errors_of, matched

ERRORS = ["tracker", "clip", "object", "frame", "error_px"]


class EvaluateTrackersParams(Section):
    """What counts as off track, as a swap, as disturbed; and how sure the mean is."""

    off_track_radii: float = Field(gt=0)
    """Error, in radii of the object, beyond which a tracker is off its track."""
    off_track_frames: int = Field(ge=1)
    """Frames in a row after which a clip counts as off track."""
    swap_frames: int = Field(ge=1)
    """Frames in a row with exchanged objects after which a clip counts as swapped."""
    bootstrap_resamples: int = Field(ge=1)
    """Draws of clips behind the 95 % interval of the mean error."""
    other_motion: OtherMotionParams


def score_trackers(
    clips: ClipSet,
    truth: pd.DataFrame,
    tables: Mapping[str, pd.DataFrame],
    verdicts: Mapping[str, Mapping[str, bool | float]],
    params: EvaluateTrackersParams,
    ball: BallParams,
) -> tuple[dict[str, dict[str, float | bool | None]], pd.DataFrame]:
    """Figures per tracker, and one row per tracker, clip, object and frame with its error (NaN where lost).

    `verdicts` holds what a tracker says of itself without labels: `locked` and `score`, null where it is silent.
    Without an annotated test clip every figure is null and `clips` is 0. Errors are those of the tracks that fit the
    objects best over a clip, one to one: a track too many is passed over, an object without a track is lost. Figures of
    identity count both, and are null for one object.
    """
    cases = annotated_cases(clips, truth, params.other_motion, ball.ball_radius_px)
    figures: dict[str, dict[str, float | bool | None]] = {}
    rows = []
    for name, table in progress(tables.items(), "errors of trackers"):
        known = tracks.by_clip(table)
        found = [matched(known.get(case.clip), case) for case in cases]
        errors = errors_of(found, cases)
        figures[name] = {
            **_figures(found, cases, errors, params, ball),
            **_identity(known, tracks.ambiguous(table), cases, 2 * ball.ball_radius_px),
            **{key: verdicts.get(name, {}).get(key) for key in ("locked", "score")},
        }
        rows.append(errors.assign(tracker=name)[ERRORS])
    return figures, pd.concat(rows, ignore_index=True)


def _figures(
    found: list[NDArray[np.floating]],
    cases: list[Case],
    errors: pd.DataFrame,
    params: EvaluateTrackersParams,
    ball: BallParams,
) -> dict[str, float]:
    seen = errors.dropna()
    per_clip = seen.groupby("clip")["error_px"].agg(["sum", "size"])
    low, high = metrics.bootstrap_interval(
        per_clip["sum"].to_numpy(float), per_clip["size"].to_numpy(float), params.bootstrap_resamples
    )
    pairs = list(zip(found, cases, strict=True))
    limit_px = params.off_track_radii * ball.ball_radius_px
    off_track = [
        metrics.off_track(xy[:, k], case.truth[:, k], limit_px, params.off_track_frames)
        for xy, case in pairs
        for k in range(case.truth.shape[1])
    ]
    swaps = [
        metrics.swapped(xy, case.truth, 2 * ball.ball_radius_px, params.swap_frames)
        for xy, case in pairs
        if case.truth.shape[1] > 1
    ]
    return {
        "clips": len(cases),
        "frames": len(errors),
        **metrics.error_figures(seen[["x", "y"]].to_numpy(float)),
        "mean_px_low": low,
        "mean_px_high": high,
        "lost": _mean(errors["error_px"].isna()),
        "delta_avg": _mean([metrics.delta_avg(xy, case.truth, case.width, case.height) for xy, case in pairs]),
        "off_track": _mean(off_track),
        "swaps": _mean(swaps),
        "disturbed": _mean(errors["disturbed"]),
        **_apart(seen, "alone", seen["disturbed"] == 0),
        **_apart(seen, "disturbed", seen["disturbed"] == 1),
    }


def _identity(
    known: Mapping[str, NDArray[np.floating]],
    flagged: Mapping[str, NDArray[np.bool_]],
    cases: list[Case],
    diameter_px: float,
) -> dict[str, float | int]:
    """Figures of identity over the clips with several objects; NaN where there is none."""
    several = []
    for case in cases:
        T, K = case.truth.shape[:2]
        if K > 1:
            found = known.get(case.clip, np.empty((T, 0, 2)))
            several.append(Tracked(found, case.truth, flagged.get(case.clip, np.empty((T, 0), bool))))
    return identity.identity_figures(several, diameter_px)


def _apart(seen: pd.DataFrame, name: str, which: pd.Series) -> dict[str, float]:
    """Mean, median and 99th percentile of some of the frames, named `mean_px_<name>` and so on."""
    figures = metrics.error_figures(seen.loc[which, ["x", "y"]].to_numpy(float))
    return {f"{key}_{name}": figures[key] for key in ("mean_px", "median_px", "p99_px")}


def _mean(values: list[float] | list[bool] | pd.Series) -> float:
    """The mean, or NaN of nothing."""
    return float(np.mean(values)) if len(values) else np.nan
