"""Which figures the page's tables show, and the few that come first."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from physpipe.report.evidence import Evidence, Row
from physpipe.report.paper import predictor_rows, tracker_rows
from physpipe.report.run import TUNED

TRACKER_COLUMNS = {
    "mean_px": "mean px",
    "median_px": "median px",
    "var_px2": "variance px²",
    "p99_px": "99 % px",
    "bias_px": "bias px",
    "jitter_px": "jitter px",
    "off_track": "off track",
    "lost": "lost",
    "swaps": "swapped",
    "hota": "HOTA",
    "idf1": "IDF1",
    "idf1_unflagged": "IDF1 unflagged",
    "id_switches": "switches",
    "delta_avg": "δ avg",
    "locked": "locked",
}
PREDICTOR_COLUMNS = {
    "error_T_px": "at T px",
    "error_2T_px": "at 2T px",
    "error_4T_px": "at 4T px",
    "ade_px": "ADE px",
    "skill_T": "skill at T",
    "nll_nats": "NLL at T, nats",
    "nll_bits": "NLL at T, bits (the paper's “perplexity”)",
    "coverage_90": "90 % coverage",
    "energy_off_T": "energy off at T",
    "energy_off_2T": "energy off at 2T",
}
HORIZONS = {"error_T_px": "T", "error_2T_px": "2T"}
SUPERVISION_WORDS = {
    "tracks": "unsupervised tracks",
    "truth": "true positions",
    TUNED: "unsupervised tracks, tuned with the tracker",
}

TUNING_WORDS = {
    "unlocked": "not locked",
    "score": "tracker's score",
    "tracker_px": "detections from the refined tracks, px",
    "forecast_px": "forecasts from the refined tracks, px",
    "forecast_loss": "the predictor's own validation",
}

Line = tuple[str, Any, Any, Any, str]
"""What, ours, the paper's, standing still's, and the model."""


def known_columns(rows: dict[str, Row], columns: dict[str, str]) -> dict[str, str]:
    """Those of `columns` that some row has a figure for."""
    return {key: heading for key, heading in columns.items() if any(row.get(key) is not None for row in rows.values())}


class Headline(NamedTuple):
    """One figure of ours beside the paper's, and beside standing still where that is a forecast too."""

    dataset: str
    what: str
    ours: Any
    paper: Any
    persistence: Any
    model: str
    """`tracker:<name>` or `predictor:<name>`, or nothing."""


def headlines(every: Sequence[Evidence], predictor: str) -> list[Headline]:
    """The first table of the page; `predictor` names the one whose errors it holds."""
    return [Headline(each.name, *values) for each in every for values in _lines(each, predictor)]


def _lines(evidence: Evidence, predictor: str) -> Iterator[Line]:
    if evidence.annotated:
        yield from _of_tracker(tracker_rows(evidence))
        yield from _of_predictor(predictor_rows(evidence), predictor)
    else:
        yield "no truth, so no error can be stated", None, None, None, ""


def _of_tracker(rows: dict[str, Row]) -> Iterator[Line]:
    ours = rows.get("unsupervised", {})
    model = "tracker:unsupervised"
    yield "unsupervised tracker, mean", ours.get("mean_px"), ours.get("paper_mean_px"), None, model
    yield "unsupervised tracker, 99 % of frames within", ours.get("p99_px"), None, None, model


def _of_predictor(blocks: dict[str, dict[str, Row]], predictor: str) -> Iterator[Line]:
    for supervision, rows in blocks.items():
        ours, still = rows.get(predictor, {}), blocks["truth" if supervision == "truth" else "tracks"]["persistence"]
        for key, horizon in HORIZONS.items() if ours else ():
            what = f"{predictor} from {SUPERVISION_WORDS[supervision]}, at {horizon}"
            yield what, ours.get(key), ours.get(f"paper_{key}"), still.get(key), f"predictor:{predictor}"
