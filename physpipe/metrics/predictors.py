"""How far forecasts are from the truth: pure functions of arrays.

Positions are (N, K, 2) pixels, covariances (N, K, 2, 2) square pixels; NaN where the truth is not known.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.stats import chi2, norm

from physpipe.metrics.trackers import distance

Floats = NDArray[np.floating]
DIRECTIONS = 64
"""Of the energy score's integral; leaves it within 0.1 % even where the error is hundreds of standard deviations."""


def pairing(found: Floats, truth: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Which of `found` (K, 2) belongs to which of `truth` (M, 2), one to one by least total distance: two index arrays.

    A true object that is not visible fits anything.
    """
    objects, forecasts = linear_sum_assignment(np.nan_to_num(distance(found[None], truth[:, None])))
    return forecasts, objects


def squared_mahalanobis(mean: Floats, cov: Floats, truth: Floats) -> Floats:
    """(N, K) squared distance in standard deviations."""
    missed = (truth - mean)[..., None].astype(np.float64)
    return (missed.swapaxes(-1, -2) @ np.linalg.solve(cov.astype(np.float64), missed))[..., 0, 0]


def gaussian_nll(mean: Floats, cov: Floats, truth: Floats) -> Floats:
    """(N, K) negative log density of the truth in nats; divide by ln 2 for bits (the paper's "perplexity" exponent)."""
    log_determinant = np.linalg.slogdet(cov.astype(np.float64))[1]
    return 0.5 * (squared_mahalanobis(mean, cov, truth) + log_determinant) + np.log(2 * np.pi)


def covered(mean: Floats, cov: Floats, truth: Floats, level: float) -> Floats:
    """(N, K) 1 where the truth lies in the ellipse that holds it with probability `level`, else 0; NaN if unknown."""
    squared = squared_mahalanobis(mean, cov, truth)
    return np.where(np.isnan(squared), np.nan, squared <= chi2.ppf(level, df=2))


def energy_score(mean: Floats, cov: Floats, truth: Floats) -> Floats:
    """(N, K) px: E|X - y| - E|X - X'| / 2 of truth y and X, X' of the forecast Gaussian (Gneiting and Raftery 2007).

    Proper, and the error itself for a forecast without spread. A plane vector is pi / 2 times as long as its
    projection on a line is on average over all lines, so this is pi / 2 times the mean CRPS of the projections, whose
    closed form for a Gaussian is Gneiting et al. 2005, equation 5.
    """
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    lines = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    std = np.sqrt(np.einsum("nkij,di,dj->nkd", cov.astype(np.float64), lines, lines))
    z = (truth - mean).astype(np.float64) @ lines.T / std
    crps = std * (z * (2 * norm.cdf(z) - 1) + 2 * norm.pdf(z) - 1 / np.sqrt(np.pi))
    return np.pi / 2 * crps.mean(axis=-1)


def first_touch(xy: Floats, within_px: float) -> Floats:
    """(K,) first frame of `xy` (T, K, 2) in which an object is nearer than that to another; infinite if in none.

    An object that is not visible touches nothing. NaN for a lone object.
    """
    K = xy.shape[1]
    apart = distance(xy[:, :, None], xy[:, None]) + np.where(np.eye(K), np.inf, 0)
    touching = (apart < within_px).any(axis=2)  # (T, K)
    return np.where(touching.any(axis=0), touching.argmax(axis=0), np.inf if K > 1 else np.nan)


def polynomial_errors(xy: Floats, degree: int, fitted_frames: int, frames: list[int]) -> Floats:
    """(len(frames), K) error in px of the least-squares polynomial through the first positions of xy (T, K, 2).

    How hard the motion itself is, whatever tracker looks at it; NaN for frames past the end.
    """
    T, K = xy.shape[:2]
    errors = np.full((len(frames), K), np.nan)
    if fitted_frames > T:
        return errors
    coefficients = np.polynomial.polynomial.polyfit(
        np.arange(fitted_frames), xy[:fitted_frames].reshape(fitted_frames, -1).astype(np.float64), degree
    )
    for row, frame in enumerate(frames):
        if frame < T:
            at = np.polynomial.polynomial.polyval(frame, coefficients).reshape(K, 2)
            errors[row] = distance(at, xy[frame])
    return errors
