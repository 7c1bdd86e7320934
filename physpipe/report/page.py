"""The page: one HTML file that opens anywhere, with its pictures, film, script and style inside it."""

import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from physpipe.core.progress import progress
from physpipe.io.atomic import replacing_folder
from physpipe.report import ablation, charts, colours
from physpipe.report.evidence import Evidence, Row
from physpipe.report.glossary import glossary
from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS, TUNING_WORDS, headlines, known_columns
from physpipe.report.heat import heat_columns
from physpipe.report.paper import calibration_row, predictor_rows, tracker_rows
from physpipe.report.params import ReportParams
from physpipe.report.plate import plate
from physpipe.report.playing import excerpts, film, shown_clips
from physpipe.report.spans import doubtful_spans
from physpipe.report.stills import stills
from physpipe.report.verdict import verdict
from physpipe.tracknet.signals import LockParams

SCRIPTS = ("page", "scale", "chart", "strip", "marks", "player", "controls", "table", "filters", "start")
STYLES = ("page", "player", "chart", "print")


def write_page(
    folder: Path,
    every: Sequence[Evidence],
    measured: Mapping[str, Any],
    seed: int,
    params: ReportParams,
    bounds: LockParams,
) -> None:
    """Writes `index.html` into `folder`, which appears only when complete.

    `measured` is metrics/ablation.json, `bounds` what a tracker must keep to be locked.
    """
    environment = Environment(
        loader=PackageLoader("physpipe.report", "page"), autoescape=True, undefined=StrictUndefined
    )
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters["figure"] = _figure
    sections = [_section(each, params, bounds) for each in progress(every, "report")]
    html = environment.get_template("index.html").render(
        sections=sections,
        seed=seed,
        headlines=headlines(every, params.predictor),
        glossary=glossary(_columns(sections), {loss for each in every for loss in each.learning["loss"]}),
        ablation=ablation.parts(measured),
        ablated=measured.get("dataset"),
        ablation_columns=ablation.COLUMNS,
        known_columns=known_columns,
        tracker_columns=TRACKER_COLUMNS,
        predictor_columns=PREDICTOR_COLUMNS,
        supervision_titles=charts.TITLES,
        tuning_words=TUNING_WORDS,
        predictor=params.predictor,
        colours=colours,
        style=Markup(_assets(STYLES, "css")),
        script=Markup(_assets(SCRIPTS, "js")),
        data=Markup(_data(sections, params)),
    )
    with replacing_folder(folder) as temporary:
        (temporary / "index.html").write_text(html, encoding="utf-8")


def _assets(names: Sequence[str], kind: str) -> str:
    """Files of `physpipe/report/page/`, one after the other."""
    folder = files("physpipe.report") / "page"
    return "\n".join((folder / f"{name}.{kind}").read_text(encoding="utf-8") for name in names)


def _data(sections: Sequence[dict[str, Any]], params: ReportParams) -> str:
    """What the page's script reads, as JSON that cannot end the element it stands in."""
    shown = {
        "trail": params.trail_frames,
        "colours": {"objects": colours.OBJECTS, "truth": colours.TRUTH, "forecast": colours.FORECAST},
        "charts": {section["name"]: section["charts"] for section in sections},
        "films": {section["name"]: section["film"] for section in sections},
    }
    return json.dumps(shown, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _columns(sections: Sequence[dict[str, Any]]) -> set[str]:
    """Keys of the columns that some table of the page has."""
    tables = [(each["trackers"], TRACKER_COLUMNS) for each in sections]
    tables += [(rows, PREDICTOR_COLUMNS) for each in sections for rows in each["predictors"].values()]
    return {key for rows, columns in tables for key in known_columns(rows, columns)}


def _section(evidence: Evidence, params: ReportParams, bounds: LockParams) -> dict[str, Any]:
    """What the template says of one data set."""
    spans = doubtful_spans(evidence.track, evidence.truth, params.span_frames, params.spans_shown)
    chosen = excerpts(evidence, shown_clips(evidence, params.film.clips), spans, params.film.frames_at_most)
    clips = evidence.clips
    return {
        "name": evidence.name,
        "simulated": evidence.simulated,
        "annotated": evidence.annotated,
        "locked": evidence.locked,
        "signals": evidence.signals,
        "verdict": verdict(evidence.signals, bounds),
        "counts": {split: len(clips.names(split)) for split in ("train", "valid", "test")},
        "objects": int(evidence.track["object"].max()) + 1 if len(evidence.track) else 0,
        "trackers": _ordered(tracker_rows(evidence)),
        "predictors": predictor_rows(evidence),
        "charts": charts.charts(evidence, params.coverage_percent),
        "horizon": evidence.horizon,
        "tuning": evidence.tuning,
        "calibration": calibration_row(evidence),
        "heat_maps": heat_columns(evidence.heat_maps, len(evidence.signals)),
        "stills": [
            stills(evidence, clip, params.frames_shown, params.upscale, params.trail_frames)
            for clip in shown_clips(evidence, params.clips_shown)
        ],
        "plate": plate(evidence, params.plate, params.upscale),
        "film": film(evidence, chosen, spans, params.predictor, params.film),
        "probabilistic": evidence.probabilistic,
        "spans": spans.to_dict("records"),
    }


def _ordered(rows: dict[str, Row]) -> dict[str, Row]:
    """Trackers in the order of their colours, ours first; others after them."""
    known = list(colours.TRACKERS)
    return dict(sorted(rows.items(), key=lambda row: known.index(row[0]) if row[0] in known else len(known)))


def _figure(value: Any) -> str:
    """A table's cell: three significant digits, yes or no, or a dash for what is not known."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.0f}" if abs(value) >= 1000 else f"{value:#.3g}".rstrip(".")
    return str(value)
