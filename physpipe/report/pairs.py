"""How far forecasts are from the truth, object by object, paired as the scores pair them."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io import forecasts, tracks
from physpipe.io.forecasts import ClipForecast
from physpipe.metrics.predictors import pairing

Array = NDArray[np.floating]


class Missed(NamedTuple):
    """One clip's forecast beside its truth, N frames of K objects that both have."""

    first: int
    """Number of the first frame forecast."""
    by_px: Array
    """(N, K, 2) truth less forecast in px, NaN where the truth is not known."""
    cov: Array | None
    """(N, K, 2, 2) px^2 of the forecast, if it has covariances."""

    def at(self, frame: int) -> Array:
        """(K, 2) px at frame number `frame`; no rows where it is not forecast or beyond the clip's end."""
        known = self.first <= frame < self.first + len(self.by_px)
        return self.by_px[frame - self.first] if known else np.empty((0, 2))

    def cov_at(self, frame: int) -> Array:
        """(K, 2, 2) px^2, likewise; no rows without covariances."""
        known = self.cov is not None and self.first <= frame < self.first + len(self.by_px)
        return self.cov[frame - self.first] if self.cov is not None and known else np.empty((0, 2, 2))

    def error_px(self, frame: int) -> float | None:
        """Mean distance over the objects whose truth is known then; None if there are none."""
        apart = np.linalg.norm(self.at(frame), axis=-1)
        apart = apart[np.isfinite(apart)]
        return float(apart.mean()) if len(apart) else None


def missed(table: pd.DataFrame, truth: pd.DataFrame) -> dict[str, Missed]:
    """Clip to its forecast beside the truth, for the clips that a forecast table and a track table share."""
    known = tracks.by_clip(truth)
    return {
        clip: _of_clip(each, known[clip])
        for clip, each in forecasts.by_clip(table).items()
        if clip in known and each.first < len(known[clip])
    }


def _of_clip(forecast: ClipForecast, whole: Array) -> Missed:
    """Objects are paired where the forecast begins, so that forecasting a swap later is an error."""
    truth = whole[forecast.first :][: len(forecast.mean)]
    mean = forecast.mean[: len(truth)]
    ours, theirs = pairing(mean[0], truth[0])
    cov = None if forecast.cov is None else forecast.cov[: len(truth), ours]
    return Missed(forecast.first, truth[:, theirs] - mean[:, ours], cov)
