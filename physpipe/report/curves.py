"""Long tables for plotting: learning curves and distributions of tracker errors."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io import results

POINTS_PER_CURVE = 100
ERROR_GRID_PX = np.geomspace(0.05, 200, 41)
"""Where distributions are read off; 200 px is beyond the diagonal of a 128-px frame."""


def curve_files(
    tracker: Path, predictors: Path, supervisions: Iterable[str], learned: Sequence[str]
) -> list[tuple[str, Path]]:
    """Models and their learning curves, of all that has learned anything on a data set; two folders hold them."""
    starts = [("tracker", tracker / part / "curve.csv") for part in ("first", "all")]
    later = [
        (f"{predictor}, {supervision}", predictors / supervision / predictor / "curve.csv")
        for supervision in supervisions
        for predictor in learned
    ]
    return [*starts, *later]


def learning_curves(files: Iterable[tuple[str, Path]]) -> pd.DataFrame:
    """Columns model, step, loss, value: every numeric column of each file's curve, thinned for drawing.

    A curve that two files hold appears once.
    """
    curves = [(model, results.load_csv(path)) for model, path in files]
    parts = [_learning_curve(model, curve) for model, curve in curves if len(curve)]
    empty = pd.DataFrame(columns=["model", "step", "loss", "value"])
    return pd.concat([empty, *parts]).drop_duplicates(ignore_index=True)


def _learning_curve(model: str, curve: pd.DataFrame) -> pd.DataFrame:
    names = f"{model}, " + curve["phase"] if "phase" in curve else model  # a phase is a training of its own
    curve = curve.assign(model=names)
    losses = [name for name in curve.select_dtypes("number") if name != "step"]
    long = curve.melt(["model", "step"], losses, "loss", "value").dropna()
    return long.groupby(["model", "loss"], sort=False, group_keys=False)[long.columns].apply(_thin)


def _thin(curve: pd.DataFrame) -> pd.DataFrame:
    kept = np.linspace(0, len(curve) - 1, min(len(curve), POINTS_PER_CURVE)).round().astype(int)
    return curve.iloc[kept]


def error_distributions(errors: pd.DataFrame) -> pd.DataFrame:
    """Columns tracker, error_px, share: share of all frames tracked within that many pixels.

    A lost frame (NaN error) is within none, so the curve of a tracker that loses objects ends below 1.
    """
    parts = [
        pd.DataFrame({"tracker": tracker, "error_px": ERROR_GRID_PX, "share": _share_within(mine.to_numpy(float))})
        for tracker, mine in errors.groupby("tracker")["error_px"]
    ]
    return pd.concat([pd.DataFrame(columns=["tracker", "error_px", "share"]), *parts], ignore_index=True)


def _share_within(errors_px: NDArray[np.float64]) -> NDArray[np.float64]:
    found = np.sort(errors_px[~np.isnan(errors_px)])
    return np.searchsorted(found, ERROR_GRID_PX, side="right") / len(errors_px)
