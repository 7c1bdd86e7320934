"""The figures that sum up how far a predictor's forecasts are from the truth."""

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from physpipe.metrics.trackers import bootstrap_interval
from physpipe.scoring.forecast_errors import LEVELS

Figures = dict[str, float | int]
MULTIPLES = {"T": 1, "2T": 2, "4T": 4}
"""Frames at which errors are told, in units of T."""
FRAMES = (10, 20, 30, 40)
"""Frames at which the paper compares inter- with extrapolation."""


def forecast_figures(
    errors: pd.DataFrame, still: Mapping[str, float], horizon: int, radius_px: float, resamples: int
) -> Figures:
    """Figures of one predictor from its `forecast_errors`; `still` are persistence's `errors_at_multiples`.

    `ade_px` and `coverage_90` are means over the frames forecast up to T, `skill_*` the share of persistence's error
    that is saved. The errors' 95 % intervals are from `resamples` draws of clips. NaN stands for what is not known.
    """
    figures: Figures = {"clips": errors.loc[errors["frame"] == horizon, "clip"].nunique()}
    for key, which in _error_rows(errors, horizon):
        per_clip = which.groupby("clip")["error_px"].agg(["sum", "size"])
        sums, sizes = per_clip["sum"].to_numpy(float), per_clip["size"].to_numpy(float)
        low, high = bootstrap_interval(sums, sizes, resamples)
        figures |= {key: mean_of_known(which["error_px"]), f"{key}_low": low, f"{key}_high": high}
    within = errors[errors["frame"] <= horizon]
    return figures | {
        "ade_px": mean_of_known(within["error_px"]),
        "fde_px": figures["error_T_px"],
        "skill_T": _skill(figures["error_T_px"], still["T"]),
        "skill_2T": _skill(figures["error_2T_px"], still["2T"]),
        **_within_radius(errors, radius_px),
        **_of_spread(errors, horizon),
        "coverage_90": mean_of_known(within["covered_90"]),
    }


def errors_at_multiples(errors: pd.DataFrame, horizon: int) -> dict[str, float]:
    """Mean error in px at T, 2 T, 4 T."""
    return {
        name: mean_of_known(errors.loc[errors["frame"] == times * horizon, "error_px"])
        for name, times in MULTIPLES.items()
    }


def mean_of_known(values: pd.Series | np.ndarray) -> float:
    """Mean of the known values, NaN of none."""
    known = np.asarray(values, float)
    known = known[np.isfinite(known)]
    return float(known.mean()) if len(known) else np.nan


def _error_rows(errors: pd.DataFrame, horizon: int) -> Iterator[tuple[str, pd.DataFrame]]:
    """Names of errors at one frame, and the rows whose mean each is."""
    for frame in FRAMES:
        yield f"error_{frame}_px", errors[errors["frame"] == frame]
    for name, times in MULTIPLES.items():
        at = errors[errors["frame"] == times * horizon]
        yield f"error_{name}_px", at
        yield f"error_{name}_px_before_collision", at[at["touched"] > at["frame"]]
        yield f"error_{name}_px_after_collision", at[at["touched"] <= at["frame"]]


def _within_radius(errors: pd.DataFrame, radius_px: float) -> Figures:
    """When forecasts leave their objects.

    `frames_to_radius` is the median over objects of the first frame whose error exceeds a radius, infinite if most
    never do until their forecast ends; `within_radius` is the share that never does.
    """
    objects = errors.groupby(["clip", "object"]).ngroups
    left = errors[errors["error_px"] > radius_px].groupby(["clip", "object"])["frame"].min()
    if not objects:
        return {"frames_to_radius": np.nan, "within_radius": np.nan}
    frames = np.concatenate([left.to_numpy(float), np.full(objects - len(left), np.inf)])
    return {"frames_to_radius": float(np.median(frames)), "within_radius": 1 - len(left) / objects}


def _of_spread(errors: pd.DataFrame, horizon: int) -> Figures:
    """How good the forecast Gaussians are at T and, apart from it, at 2 T.

    The paper calls 2^bits perplexity, but the figures that it prints under that name are the bits.
    """
    figures: Figures = {}
    for suffix, name in (("", "T"), ("_2T", "2T")):
        at = errors[errors["frame"] == MULTIPLES[name] * horizon]
        nats = mean_of_known(at["nll_nats"])
        bits = nats / np.log(2)
        with np.errstate(over="ignore"):  # a sure and wrong forecast is infinitely perplexed
            perplexity = float(np.exp2(bits))
        figures |= {f"nll_nats{suffix}": nats, f"nll_bits{suffix}": bits, f"perplexity{suffix}": perplexity}
        figures[f"energy_score_{name}_px"] = mean_of_known(at["energy_score_px"])
        figures |= {f"coverage_{level}_{name}": mean_of_known(at[f"covered_{level}"]) for level in LEVELS}
    return figures


def _skill(error: float, still: float) -> float:
    """1 for a perfect forecast, 0 for one no better than standing still; NaN when nothing moved."""
    return 1 - error / still if still > 0 else np.nan
