"""What the page's player is given of a data set: excerpts of clips as pictures, and every mark as numbers."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.report.brushes import CHI2_90
from physpipe.report.evidence import Evidence
from physpipe.report.listing import listed
from physpipe.report.overlays import marks_of
from physpipe.report.spans import nearest_px
from physpipe.report.strips import strip

LEAD_IN = 0.25
"""Share of an excerpt that comes before the span that it was cut out for."""
STATES = {"lost": "l", "ambiguous": "a"}
SURE = "t"


class FilmParams(Section):
    """The film in the page's player."""

    clips: int = Field(ge=1)
    """Number of test clips in it, at most; clips with doubtful spans come on top."""
    frames_at_most: int = Field(ge=1)
    """Frames of a clip; a longer clip is cut, and the page says so."""
    fps_at_most: float = Field(gt=0)
    """Frames a second with which playing starts; a faster camera's film starts slowed."""
    quality: int = Field(ge=1, le=100)
    """Of its pictures."""


class Excerpt(NamedTuple):
    """Consecutive frames of a clip."""

    clip: str
    first: int
    last: int


def shown_clips(evidence: Evidence, count: int) -> list[str]:
    """Up to `count` tracked clips of the test split, spread over it; of all clips where there is no test split."""
    tracked = set(evidence.track["clip"])
    names = [name for name in evidence.clips.names("test") or evidence.clips.names() if name in tracked]
    spread = np.linspace(0, len(names) - 1, min(count, len(names))).round().astype(int)
    return [names[index] for index in spread]


def excerpts(evidence: Evidence, names: Sequence[str], spans: pd.DataFrame, frames_at_most: int) -> list[Excerpt]:
    """The beginnings of clips `names`, then whatever is needed for the beginning of every span to be in one."""
    chosen = [_excerpt(evidence, name, 0, frames_at_most) for name in names]
    for clip, start in zip(spans["clip"], spans["first"], strict=True):
        if not any(each.clip == clip and each.first <= start <= each.last for each in chosen):
            chosen.append(_excerpt(evidence, clip, int(start - LEAD_IN * frames_at_most), frames_at_most))
    return chosen


def _excerpt(evidence: Evidence, clip: str, first: int, count: int) -> Excerpt:
    T = len(evidence.clips.rows(clip))
    first = max(0, min(first, T - count))
    return Excerpt(clip, first, min(first + count, T) - 1)


def film(
    evidence: Evidence, chosen: Sequence[Excerpt], spans: pd.DataFrame, predictor: str, params: FilmParams
) -> dict[str, Any]:
    """The rate in frames a second, the rate at first, T, the predictors, the doubtful spans and excerpts; for JSON.

    `predictor` is the one whose forecast is shown at first.
    """
    rate = _rate(evidence, [each.clip for each in chosen])
    return {
        "fps": rate,
        "fps_at_first": min(rate, params.fps_at_most),
        "horizon": evidence.horizon,
        "predictors": sorted(evidence.forecasts, key=lambda name: name != predictor),
        "spans": spans[["clip", "first", "last"]].to_dict("records"),
        "scenes": [_scene(evidence, each, params.quality) for each in chosen],
    }


def _rate(evidence: Evidence, names: Sequence[str]) -> float:
    steps = [np.diff(evidence.clips.times_s(name)) for name in names]
    known = np.concatenate([*steps, np.empty(0)])
    return round(1 / float(np.median(known)), 4) if len(known) else 1.0


def _scene(evidence: Evidence, excerpt: Excerpt, quality: int) -> dict[str, Any]:
    clip, shown = excerpt.clip, slice(excerpt.first, excerpt.last + 1)
    marks, frames = marks_of(evidence, clip), evidence.clips.frames(clip)
    table = evidence.track[evidence.track["clip"] == clip].sort_values(["frame", "object"])
    by_object = {key: table[key].to_numpy().reshape(len(frames), -1)[shown] for key in ("score", "status")}
    status = evidence.clips.rows(clip)["status"].to_numpy()[shown]
    return {
        "clip": clip,
        "split": evidence.clips.split(clip),
        "first": excerpt.first,
        "total": len(frames),
        "size": [frames.shape[2], frames.shape[1]],
        "times_s": listed(evidence.clips.times_s(clip)[shown], 5),
        "strip": strip(frames[shown], quality),
        "truth": listed(marks.truth[shown], 2),
        "track": listed(marks.track[shown], 2),
        "forecasts": dict(_forecasts(evidence, excerpt)),
        "score": listed(by_object["score"], 3),
        "state": ["".join(STATES.get(each, SURE) for each in row) for row in by_object["status"]],
        "track_px": listed(nearest_px(marks.track, marks.truth)[shown], 2),
        "faults": {str(number): str(each) for number, each in enumerate(status) if each != "ok"},
    }


def _forecasts(evidence: Evidence, excerpt: Excerpt) -> Iterator[tuple[str, dict[str, Any]]]:
    """Each predictor that forecasts the clip: the last frame `seen` and, from number `start` of the excerpt on, marks.

    `ellipse` is None where the predictor does not say how sure it is.
    """
    for name, table in evidence.forecasts.items():
        marks = marks_of(replace(evidence, forecast=table), excerpt.clip)
        if not marks.ahead:
            continue
        first, seen = max(excerpt.first, marks.ahead[0]), marks.ahead[0] - 1
        ahead = slice(first, excerpt.last + 1)
        sure = "cov_xx" not in table
        yield (
            name,
            {
                "seen": seen,
                "start": first - excerpt.first,
                "xy": listed(marks.forecast[ahead], 2),
                "ellipse": None if sure else listed(ellipses(marks.covariance[ahead]), 3),
                "off_px": listed(nearest_px(marks.forecast, marks.truth)[ahead], 2),
            },
        )


def ellipses(covariance: NDArray[np.floating]) -> NDArray[np.float64]:
    """Half axes in px, the longer first, and its angle in radians from x to y, of what should hold 90 %.

    (..., 2, 2) px^2 to (..., 3); NaN where there is no covariance.
    """
    known = np.isfinite(covariance).all(axis=(-2, -1))
    values, vectors = np.linalg.eigh(np.where(known[..., None, None], covariance, np.eye(2)))
    axes = np.sqrt(CHI2_90 * np.maximum(values, 0))
    angle = np.arctan2(vectors[..., 1, 1], vectors[..., 0, 1])
    found = np.stack([axes[..., 1], axes[..., 0], angle], axis=-1)
    return np.where(known[..., None], found, np.nan)
