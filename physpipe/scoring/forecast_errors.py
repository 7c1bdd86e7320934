"""How far every forecast position is from the truth, one row each: what all figures of a predictor are taken from."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io import forecasts
from physpipe.io.forecasts import ClipForecast
from physpipe.metrics import predictors as metrics
from physpipe.metrics.trackers import distance

LEVELS = (50, 90, 95)
"""Percent that a forecast's ellipse claims to hold."""
OF_SPREAD = ("nll_nats", "energy_score_px", *(f"covered_{level}" for level in LEVELS))
COLUMNS = ("clip", "object", "frame", "error_px", "touched", *OF_SPREAD)


def forecast_errors(table: pd.DataFrame, known: Mapping[str, NDArray[np.floating]], within_px: float) -> pd.DataFrame:
    """One row for each clip of `known` (T, K, 2) px, visible object and frame forecast, with `COLUMNS`.

    `touched` is the first frame of the clip in which the true centres of the object and another are nearer than
    `within_px`, infinite if there is none, NaN for a lone object. `OF_SPREAD` is NaN without a covariance.
    """
    parts = [
        _of_clip(clip, each, known[clip], within_px)
        for clip, each in forecasts.by_clip(table).items()
        if clip in known and each.first < len(known[clip])
    ]
    return pd.concat([pd.DataFrame(columns=list(COLUMNS), dtype=float), *parts], ignore_index=True)


def _of_clip(clip: str, forecast: ClipForecast, whole: NDArray[np.floating], within_px: float) -> pd.DataFrame:
    """Objects are paired where the forecast begins, so that forecasting a swap later is an error."""
    truth = whole[forecast.first :][: len(forecast.mean)]
    mean = forecast.mean[: len(truth)]
    ours, theirs = metrics.pairing(mean[0], truth[0])
    mean, truth = mean[:, ours], truth[:, theirs]
    cov = None if forecast.cov is None else forecast.cov[: len(truth), ours]
    frame, obj = np.indices(mean.shape[:2])
    columns = {
        "object": theirs[obj],
        "frame": frame + forecast.first,
        "error_px": distance(mean, truth),
        "touched": metrics.first_touch(whole, within_px)[theirs[obj]],
        **_of_spread(mean, cov, truth),
    }
    table = pd.DataFrame({"clip": clip, **{name: values.ravel() for name, values in columns.items()}})
    return table.dropna(subset="error_px")


def _of_spread(
    mean: NDArray[np.floating], cov: NDArray[np.floating] | None, truth: NDArray[np.floating]
) -> dict[str, NDArray[np.floating]]:
    """What a covariance allows to say, (N, K) each."""
    if cov is None:
        return dict.fromkeys(OF_SPREAD, np.full(mean.shape[:2], np.nan))
    return {
        "nll_nats": metrics.gaussian_nll(mean, cov, truth),
        "energy_score_px": metrics.energy_score(mean, cov, truth),
        **{f"covered_{level}": metrics.covered(mean, cov, truth, level / 100) for level in LEVELS},
    }
