"""Figures per predictor from forecast tables and the truth, test split only."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from pydantic import Field

from physpipe.core.ball import BallParams
from physpipe.core.params import Section
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.metrics import predictors as metrics
from physpipe.scoring.energy_drift import Replay, energy_figures
from physpipe.scoring.forecast_errors import forecast_errors
from physpipe.scoring.forecast_figures import errors_at_multiples, forecast_figures, mean_of_known

FITTED_FRAMES = 10
"""Positions that the paper's polynomials are fitted on."""


class EvaluatePredictorsParams(Section):
    """What counts as a collision, and how sure the errors are."""

    collision_radii: float = Field(gt=0)
    """Distance of two centres, in ball radii, below which the balls collide."""
    bootstrap_resamples: int = Field(ge=1)
    """Draws of clips behind the 95 % intervals."""


def score_predictors(
    clips: ClipSet,
    truth: pd.DataFrame,
    tables: Mapping[str, Mapping[str, pd.DataFrame]],
    horizon: int,
    params: EvaluatePredictorsParams,
    ball: BallParams,
    simulated: Mapping[str, Replay] | None,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Figures of each supervision's predictors (`tables[supervision][predictor]`), and the error of every frame.

    A figure is null when no annotated clip and no forecast reaches its frame, or when it takes a covariance or several
    objects that there are not. Without annotated clips all figures are null and `clips` is 0. The second result has
    columns supervision, predictor, frame, error_px. The test clips of a `simulated` set, rolled again, also tell how
    hard the motion is, `calibration`, and how well forecasts keep energy.
    """
    test = set(clips.names("test"))
    known = {clip: xy for clip, xy in tracks.by_clip(truth).items() if clip in test}
    figures: dict[str, Any] = {"calibration": {} if simulated is None else calibration(truth, horizon)}
    within_px = params.collision_radii * ball.ball_radius_px
    curves = []
    for supervision, predictors in tables.items():
        errors = {name: forecast_errors(table, known, within_px) for name, table in predictors.items()}
        still = errors_at_multiples(errors["persistence"], horizon)
        figures[supervision] = {
            name: forecast_figures(each, still, horizon, ball.ball_radius_px, params.bootstrap_resamples)
            | energy_figures(predictors[name], simulated or {}, horizon)
            for name, each in errors.items()
        }
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
        at_T, at_2T = (mean_of_known(np.concatenate([errors[row] for errors in every])) for row in (0, 1))
        figures |= {f"{name}_T_px": at_T, f"{name}_2T_px": at_2T}
    return figures
