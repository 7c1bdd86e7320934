"""A contact sheet of marked frames: what the page shows before anything plays, and on paper."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physpipe.report.embedding import webp
from physpipe.report.evidence import Evidence
from physpipe.report.overlays import Marks, draw, marks_of
from physpipe.report.spans import nearest_px

QUALITY = 80


def stills(evidence: Evidence, clip: str, count: int, upscale: int, trail: int) -> list[dict[str, Any]]:
    """A clip's row: `count` pictures, from the last seen frame to the last forecast one, and what is said of each."""
    marks, frames, times = marks_of(evidence, clip), evidence.clips.frames(clip), evidence.clips.times_s(clip)
    track_px, forecast_px = (nearest_px(xy, marks.truth) for xy in (marks.track, marks.forecast))
    return [
        {
            "clip": clip,
            "frame": t,
            "time_s": float(times[t]),
            "track_px": _mean(track_px[t]),
            "forecast_px": _mean(forecast_px[t]),
            "picture": webp(draw(frames[t], marks, t, upscale, trail), QUALITY),
        }
        for t in _moments(marks, len(frames), count)
    ]


def _moments(marks: Marks, T: int, count: int) -> list[int]:
    """Numbers of the frames shown: spread from the last seen to the last forecast one, or over the clip."""
    first, last = (max(marks.ahead[0] - 1, 0), marks.ahead[-1]) if marks.ahead else (0, T - 1)
    return sorted({round(float(t)) for t in np.linspace(first, last, count)})


def _mean(values: NDArray[np.floating]) -> float | None:
    found = values[np.isfinite(values)]
    return float(found.mean()) if len(found) else None
