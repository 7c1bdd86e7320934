"""Figures per predictor from forecast tables and the truth, test split only."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from pydantic import Field

from physpipe.core.params import Section
from physpipe.io import forecasts, tracks
from physpipe.io.clips import ClipSet
from physpipe.io.forecasts import ClipForecast
from physpipe.metrics import predictors as metrics
from physpipe.metrics.trackers import bootstrap_interval, distance

Figures = dict[str, float | int | None]
ERRORS = ["clip", "object", "frame", "error_px", "nll_nats", "covered_90"]
FITTED_FRAMES = 10
"""Positions that the paper's polynomials are fitted on."""
MULTIPLES = {"T": 1, "2T": 2, "4T": 4}


class EvaluatePredictorsParams(Section):
    """How sure the errors are."""

    bootstrap_resamples: int = Field(ge=1)
    """Draws of clips behind the 95 % intervals."""


def score_predictors(
    clips: ClipSet,
    truth: pd.DataFrame,
    tables: Mapping[str, Mapping[str, pd.DataFrame]],
    horizon: int,
    params: EvaluatePredictorsParams,
    exact: bool,
) -> tuple[dict[str, object], pd.DataFrame]:
    """Figures of each supervision's predictors (`tables[supervision][predictor]`), and the error of every frame.

    Errors at T, 2 T, 4 T are those of that frame of the clip, null when no annotated clip reaches it. `ade_px` is the
    mean over the frames forecast up to T, `skill` the share of persistence's error that is saved. The second result has
    columns supervision, predictor, frame, error_px. Without annotated clips all figures are null and `clips` is 0.
    `exact` truth, of a simulated set, also tells how hard the motion is: `calibration`.
    """
    test = set(clips.names("test"))
    known = {clip: xy for clip, xy in tracks.by_clip(truth).items() if clip in test}
    figures: dict[str, object] = {"calibration": calibration(truth, horizon) if exact else {}}
    curves = []
    for supervision, predictors in tables.items():
        errors = {name: _errors(table, known) for name, table in predictors.items()}
        still = _at_multiples(errors["persistence"], horizon)
        figures[supervision] = {name: _figures(each, still, horizon, params) for name, each in errors.items()}
        for name, each in errors.items():
            curve = each.groupby("frame", as_index=False)["error_px"].mean().dropna()
            curves.append(curve.assign(supervision=supervision, predictor=name))
    columns = ["supervision", "predictor", "frame", "error_px"]
    return figures, pd.concat(curves)[columns].astype({"frame": int})


def calibration(truth: pd.DataFrame, horizon: int) -> dict[str, float]:
    """Errors of least-squares polynomials on true positions of all clips: how hard a simulated set's motion is.

    Empty without truth.
    """
    if truth.empty:
        return {}
    figures: dict[str, float] = {}
    for name, degree in (("linear", 1), ("quadratic", 2)):
        frames = [horizon, 2 * horizon]
        every = [metrics.polynomial_errors(xy, degree, FITTED_FRAMES, frames) for xy in tracks.by_clip(truth).values()]
        at_T, at_2T = (_mean(np.concatenate([errors[row] for errors in every])) for row in (0, 1))
        figures |= {f"{name}_T_px": at_T, f"{name}_2T_px": at_2T}
    return figures


def _errors(table: pd.DataFrame, known: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """One row for each annotated clip, object and frame forecast: error_px, and what a covariance allows to say."""
    parts = [_clip_errors(clip, each, known[clip]) for clip, each in forecasts.by_clip(table).items() if clip in known]
    return pd.concat([pd.DataFrame(columns=ERRORS, dtype=float), *parts], ignore_index=True)


def _clip_errors(clip: str, forecast: ClipForecast, truth: np.ndarray) -> pd.DataFrame:
    """Objects are paired where the forecast begins, so that forecasting a swap later is an error."""
    truth = truth[forecast.first :][: len(forecast.mean)]
    mean = forecast.mean[: len(truth)]
    if not len(truth):
        return pd.DataFrame(columns=ERRORS, dtype=float)
    ours, theirs = metrics.pairing(mean[0], truth[0])
    mean, truth = mean[:, ours], truth[:, theirs]
    nll = inside = np.full(mean.shape[:2], np.nan)
    if forecast.cov is not None:
        cov = forecast.cov[: len(truth), ours]
        nll, inside = metrics.gaussian_nll(mean, cov, truth), metrics.covered(mean, cov, truth, 0.9)
    frame, obj = np.indices(mean.shape[:2])
    columns = {
        "clip": clip,
        "object": theirs[obj.ravel()],
        "frame": frame.ravel() + forecast.first,
        "error_px": distance(mean, truth).ravel(),
        "nll_nats": nll.ravel(),
        "covered_90": inside.ravel(),
    }
    return pd.DataFrame(columns).dropna(subset="error_px")


def _figures(
    errors: pd.DataFrame, still: Mapping[str, float], horizon: int, params: EvaluatePredictorsParams
) -> Figures:
    figures: Figures = {"clips": errors.loc[errors["frame"] == horizon, "clip"].nunique()}
    reached = _at_multiples(errors, horizon)
    for name, times in MULTIPLES.items():
        per_clip = errors[errors["frame"] == times * horizon].groupby("clip")["error_px"].agg(["sum", "size"])
        sums, sizes = per_clip["sum"].to_numpy(float), per_clip["size"].to_numpy(float)
        low, high = bootstrap_interval(sums, sizes, params.bootstrap_resamples)
        figures |= {
            f"error_{name}_px": reached[name],
            f"error_{name}_px_low": low,
            f"error_{name}_px_high": high,
        }
    within = errors[errors["frame"] <= horizon]
    nll_nats = _mean(errors.loc[errors["frame"] == horizon, "nll_nats"])
    return figures | {
        "ade_px": _mean(within["error_px"]),
        "fde_px": reached["T"],
        "skill_T": _skill(reached["T"], still["T"]),
        "skill_2T": _skill(reached["2T"], still["2T"]),
        "nll_nats": nll_nats,
        "nll_bits": nll_nats / np.log(2),
        "coverage_90": _mean(within["covered_90"]),
    }


def _at_multiples(errors: pd.DataFrame, horizon: int) -> dict[str, float]:
    """Mean error in px at T, 2 T, 4 T."""
    return {
        name: _mean(errors.loc[errors["frame"] == times * horizon, "error_px"]) for name, times in MULTIPLES.items()
    }


def _skill(error: float, still: float) -> float:
    """1 for a perfect forecast, 0 for one no better than standing still; NaN when nothing moved."""
    return 1 - error / still if still > 0 else np.nan


def _mean(values: pd.Series | np.ndarray) -> float:
    """Mean of the known values, NaN of none."""
    known = np.asarray(values, float)
    known = known[np.isfinite(known)]
    return float(known.mean()) if len(known) else np.nan
