"""Whether forecasts are as sure as they claim: how often the truth is inside the ellipse that claims to hold p %."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.metrics.predictors import squared_mahalanobis
from physpipe.report import colours
from physpipe.report.evidence import Evidence
from physpipe.report.line import Chart, line
from physpipe.report.pairs import missed

MULTIPLES = {"T": 1, "2T": 2}
"""Where it is told, in units of T."""
COLUMNS = ["predictor", "at", "percent", "share", "positions"]


def coverage(evidence: Evidence, percent: Sequence[float]) -> pd.DataFrame:
    """Columns COLUMNS: the `share` of the true `positions` at T and 2T that are inside the `percent` % ellipse.

    Of the forecasts from unsupervised tracks that have covariances, on annotated test clips; no rows without any.
    """
    return pd.DataFrame(list(_rows(evidence, percent)), columns=COLUMNS)


def coverage_charts(shares: pd.DataFrame, horizon: int) -> Iterator[Chart]:
    """A panel at T and one at 2T: the share of true positions inside the ellipse that claims to hold so many percent.

    The line without a model is what is claimed.
    """
    claimed = pd.DataFrame({"percent": [0, *shares["percent"].unique(), 100]}).sort_values("percent")
    claimed = claimed.assign(share=claimed["percent"] / 100)
    for at, mine in shares.groupby("at", sort=False):
        lines = [
            line(
                f"{name}, n = {curve['positions'].iloc[0]}",
                f"predictor:{name}",
                colours.of_predictor(str(name)),
                curve[["percent", "share"]],
                wide=True,
            )
            for name, curve in mine.groupby("predictor", sort=False)
        ]
        yield {
            "title": f"at {at} = {MULTIPLES[str(at)] * horizon}",
            "x": {"label": "claimed, %", "scale": "linear", "at": "{} % ellipse"},
            "y": {"label": "share inside", "scale": "linear", "percent": True, "from": 0, "to": 1},
            "lines": [*lines, line("as claimed", "", colours.REFERENCE, claimed, dashed=True)],
        }


def _rows(evidence: Evidence, percent: Sequence[float]) -> Iterator[tuple[Any, ...]]:
    claimed = np.asarray(percent, float)
    for predictor, table in evidence.forecasts.items():
        if "cov_xx" not in table:
            continue
        clips = missed(table, evidence.truth).values()
        for at, times in MULTIPLES.items():
            frame = times * evidence.horizon
            missed_by = [(each.at(frame), each.cov_at(frame)) for each in clips]
            squared = [squared_mahalanobis(np.zeros_like(by_px), cov, by_px) for by_px, cov in missed_by]
            known = np.concatenate([*squared, np.empty(0)])
            known = known[np.isfinite(known)]
            for level, share in zip(percent, shares_inside(known, claimed), strict=True):
                if len(known):
                    yield predictor, at, level, share, len(known)


def shares_inside(squared: NDArray[np.floating], percent: NDArray[np.floating]) -> NDArray[np.float64]:
    """(L,) share of the `squared` distances (N,) within the ellipses that hold `percent` (L,) of a plane Gaussian."""
    radius = -2 * np.log1p(-percent / 100)
    return np.searchsorted(np.sort(squared), radius, side="right") / max(len(squared), 1)
