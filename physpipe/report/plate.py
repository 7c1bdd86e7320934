"""The plate: a test clip of each data set, with its true path and every predictor's forecast of it."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pydantic import Field

from physpipe.core.params import Section
from physpipe.report.brushes import Picture
from physpipe.report.embedding import webp
from physpipe.report.evidence import Evidence
from physpipe.report.overlays import marks_of
from physpipe.report.pairs import missed
from physpipe.report.paths import background, draw_paths
from physpipe.report.stills import QUALITY

COLUMNS = 6
"""Panels side by side, at most."""
PATHLESS = "persistence"
"""Standing still has no path to draw."""


class PlateParams(Section):
    """The pictures of whole forecasts."""

    reach: int = Field(ge=1)
    """Last frame drawn, in T."""
    spots: int = Field(ge=0)
    """Frames at which rings, dots and ellipses stand on the paths, evenly up to the last one drawn."""
    background_frames: int = Field(ge=1)
    """Frames of the clip whose median is the background."""


class Choice(NamedTuple):
    """The clip that is drawn, and what it was chosen for."""

    clip: str
    error_px: float | None
    """Of the headline predictor at T; None where there is no truth to choose by."""
    of: int
    """Clips that it was chosen among."""


def median_clip(evidence: Evidence) -> Choice | None:
    """The test clip whose error at T is the median of the headline predictor's, the lower one of two in the middle.

    Where no error is known, the middle one of the clips that are forecast, by name; None where none is.
    """
    tracked, asked = set(evidence.track["clip"]), set(evidence.forecast["clip"])
    tests = evidence.clips.names("test") or evidence.clips.names()
    names = [name for name in tests if name in tracked and name in asked]
    found = missed(evidence.forecast, evidence.truth)
    errors = {name: found[name].error_px(evidence.horizon) for name in names if name in found}
    known = sorted((error, name) for name, error in errors.items() if error is not None)
    if known:
        error, clip = known[(len(known) - 1) // 2]
        return Choice(clip, error, len(known))
    return Choice(names[(len(names) - 1) // 2], None, len(names)) if names else None


def plate(evidence: Evidence, params: PlateParams, upscale: int) -> dict[str, Any] | None:
    """A data set's row: its clip, why that one, and a panel a predictor; None where nothing is forecast."""
    choice = median_clip(evidence)
    if choice is None:
        return None
    clip, reach = choice.clip, params.reach * evidence.horizon
    ground = background(evidence.clips.frames(clip), params.background_frames)
    last = min(reach, len(evidence.clips.rows(clip)) - 1)
    spots = [round(reach * part / params.spots) for part in range(1, params.spots + 1)]
    drawn = [name for name in evidence.forecasts if name != PATHLESS]
    return {
        **choice._asdict(),
        "last": last,
        "spots": [t for t in spots if t <= last],
        "columns": min(COLUMNS, len(drawn)),
        "probabilistic": evidence.probabilistic,
        "panels": [_panel(evidence, each, clip, ground, reach, spots, upscale) for each in drawn],
    }


def _panel(
    evidence: Evidence, predictor: str, clip: str, ground: Picture, last: int, spots: Sequence[int], upscale: int
) -> dict[str, Any]:
    """One predictor's picture, the last frame that it saw, and its mean errors in px, None where not known."""
    table = evidence.forecasts[predictor]
    table = table[table["clip"] == clip]
    marks = marks_of(replace(evidence, forecast=table), clip)
    found = missed(table, evidence.truth[evidence.truth["clip"] == clip]).get(clip)
    return {
        "predictor": predictor,
        "seen": marks.ahead[0] - 1 if marks.ahead else None,
        "T_px": found and found.error_px(evidence.horizon),
        "2T_px": found and found.error_px(2 * evidence.horizon),
        "picture": webp(draw_paths(ground, marks, last, spots, upscale), QUALITY),
    }
