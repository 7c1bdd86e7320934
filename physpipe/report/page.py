"""The page: one HTML file that opens anywhere, with every picture and film inside it."""

import base64
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.core.progress import progress
from physpipe.io.atomic import replacing_folder
from physpipe.report import colours, figures
from physpipe.report.curves import error_distributions
from physpipe.report.film import FilmParams, shown_clips, write_film
from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS, headlines, known_columns
from physpipe.report.overlays import Marks, draw, marks_of
from physpipe.report.paper import calibration_row, predictor_rows, tracker_rows
from physpipe.report.run import Evidence, Row
from physpipe.report.spans import doubtful_spans, nearest_px

JPEG_QUALITY = 85


class ReportParams(Section):
    """What the report shows."""

    predictor: str
    """Predictor of the headline figures, pictures and films; one of run.learned, or a baseline."""
    clips_shown: int = Field(ge=1)
    """Number of test clips in a data set's contact sheet, at most; a row each."""
    frames_shown: int = Field(ge=1)
    """Pictures of each of those clips, from the last seen frame to the last forecast one."""
    upscale: int = Field(ge=1)
    """Pixels of a picture per pixel of a clip."""
    trail_frames: int = Field(ge=0)
    """Past positions drawn behind a tracked object, in frames."""
    spans_shown: int = Field(ge=0)
    """Number of doubtful spans of the track in the table."""
    span_frames: int = Field(ge=1)
    """Length of a doubtful span in frames."""
    film: FilmParams


def write_page(folder: Path, every: Sequence[Evidence], seed: int, params: ReportParams) -> None:
    """Writes `index.html` and `<data set>.mp4` into `folder`, which appears only when complete."""
    environment = Environment(loader=PackageLoader("physpipe.report", "."), autoescape=True, undefined=StrictUndefined)
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters["figure"] = _figure
    with replacing_folder(folder) as temporary:
        sections = [_section(each, temporary, params) for each in progress(every, "report")]
        html = environment.get_template("page.html").render(
            sections=sections,
            seed=seed,
            headlines=headlines(every, params.predictor),
            known_columns=known_columns,
            tracker_columns=TRACKER_COLUMNS,
            predictor_columns=PREDICTOR_COLUMNS,
            supervision_titles=figures.TITLES,
            predictor=params.predictor,
            colours=colours,
        )
        (temporary / "index.html").write_text(html, encoding="utf-8")


def _section(evidence: Evidence, folder: Path, params: ReportParams) -> dict[str, Any]:
    """What the template says of one data set."""
    film = folder / f"{evidence.name}.mp4"
    write_film(film, evidence, params.predictor, params.upscale, params.trail_frames, params.film)
    spans = doubtful_spans(evidence.track, evidence.truth, params.span_frames, params.spans_shown)
    clips = evidence.clips
    return {
        "name": evidence.name,
        "simulated": evidence.simulated,
        "annotated": evidence.annotated,
        "locked": evidence.locked,
        "signals": evidence.signals,
        "counts": {split: len(clips.names(split)) for split in ("train", "valid", "test")},
        "objects": int(evidence.track["object"].max()) + 1,
        "trackers": _ordered(tracker_rows(evidence)),
        "predictors": predictor_rows(evidence),
        "figures": _figures(evidence),
        "horizon": evidence.horizon,
        "calibration": calibration_row(evidence),
        "heat_maps": [_embedded("image/png", each) for each in evidence.heat_maps],
        "tiles": [_tiles(evidence, clip, params) for clip in shown_clips(evidence, params.clips_shown)],
        "film": _embedded("video/mp4", film.read_bytes()),
        "spans": spans.to_dict("records"),
    }


def _ordered(rows: dict[str, Row]) -> dict[str, Row]:
    """Trackers in the order of their colours, ours first; others after them."""
    known = list(colours.TRACKERS)
    return dict(sorted(rows.items(), key=lambda row: known.index(row[0]) if row[0] in known else len(known)))


def _figures(evidence: Evidence) -> dict[str, str]:
    """Name of a figure to its picture, for those that there are data for."""
    of_tracker = evidence.learning["model"].str.startswith("tracker")
    drawn: dict[str, tuple[Callable[[pd.DataFrame], bytes], pd.DataFrame]] = {
        "horizons": (partial(figures.error_by_horizon, horizon=evidence.horizon), evidence.horizons),
        "tracker_errors": (figures.tracker_errors, error_distributions(evidence.tracker_errors)),
        "tracker_learning": (figures.learning_curves, evidence.learning[of_tracker]),
        "predictor_learning": (figures.learning_curves, evidence.learning[~of_tracker]),
    }
    return {name: _embedded("image/png", draw_it(table)) for name, (draw_it, table) in drawn.items() if len(table)}


def _tiles(evidence: Evidence, clip: str, params: ReportParams) -> list[dict[str, Any]]:
    """A clip's row of the contact sheet: pictures and what their captions say."""
    marks, frames, times = marks_of(evidence, clip), evidence.clips.frames(clip), evidence.clips.times_s(clip)
    track_px, forecast_px = (nearest_px(xy, marks.truth) for xy in (marks.track, marks.forecast))
    return [
        {
            "clip": clip,
            "frame": t,
            "time_s": float(times[t]),
            "track_px": _mean(track_px[t]),
            "forecast_px": _mean(forecast_px[t]),
            "picture": _embedded("image/jpeg", _jpeg(draw(frames[t], marks, t, params.upscale, params.trail_frames))),
        }
        for t in _moments(marks, len(frames), params.frames_shown)
    ]


def _moments(marks: Marks, T: int, count: int) -> list[int]:
    """Numbers of the frames shown: spread from the last seen to the last forecast one, or over the clip."""
    first, last = (max(marks.ahead[0] - 1, 0), marks.ahead[-1]) if marks.ahead else (0, T - 1)
    return sorted({round(float(t)) for t in np.linspace(first, last, count)})


def _mean(values: NDArray[np.floating]) -> float | None:
    found = values[np.isfinite(values)]
    return float(found.mean()) if len(found) else None


def _jpeg(picture: NDArray[np.uint8]) -> bytes:
    coded = cv2.imencode(".jpg", picture[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1]
    return coded.tobytes()


def _embedded(kind: str, content: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _figure(value: Any) -> str:
    """A table's cell: three significant digits, yes or no, or a dash for what is not known."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.0f}" if abs(value) >= 1000 else f"{value:#.3g}".rstrip(".")
    return str(value)
