"""What the page's short words mean."""

from collections.abc import Collection
from typing import NamedTuple

from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS

LOSSES = {
    "train": "training loss",
    "valid": "validation loss",
    "order_nats": "order, nats",
    "entropy_nats": "entropy of the heat map, nats",
    "siamese_px2": "turning error, px²",
    "sigma_px": "noise on positions, px",
    "motion_nats": "motion, nats",
    "train_last_px": "error at the last frame, px",
    "train_seen_px": "error on seen frames, px",
    "train_nll_nats": "NLL, nats",
}
"""Column of a learning curve to the words for it."""
COLUMN_MEANINGS = {
    "off_track": "share of objects that the tracker left, or lost, for many frames in a row at least once in a clip",
    "swaps": "share of clips in which tracks exchanged their objects for many frames in a row",
    "hota": "higher-order tracking accuracy, 0 to 1: the geometric mean of how well objects are found and how well "
    "each keeps its own track",
    "idf1": "share of positions that carry the right object's number, 0 to 1: of those tracked and of those there are",
    "idf1_unflagged": "IDF1 without the frames that the tracker itself flags as perhaps mistaken",
    "id_switches": "how often an object goes on under another number",
    "delta_avg": "share of positions within 1, 2, 4, 8 and 16 px of the truth, averaged over the five, in frames "
    "stretched to 256 by 256 px (TAP-Vid)",
    "locked": "whether the tracker found an object, by its own verdict without labels",
    "error_T_px": "mean error at frame T, which is as far as predictors learned to forecast; elsewhere called final "
    "displacement error, FDE",
    "ade_px": "average displacement error: the mean over all frames forecast up to T",
    "skill_T": "1 for a perfect forecast, 0 for one no better than standing still, negative for a worse one",
    "nll_nats": "negative log-likelihood of the true position, the lower the better: counts being sure and wrong",
    "coverage_90": "share of true positions inside the ellipses that should hold 90 %",
    "energy_off_T": "size of the energy that a forecast wins or loses up to T against the simulated balls, as a share "
    "of the energy where it begins",
}
LOSS_MEANINGS = {
    "order_nats": "how badly the tracker's judge tells natural from shuffled orders of positions; 0.693 is a coin's",
    "entropy_nats": "how spread out a heat map is: 0 is a single cell",
    "siamese_px2": "mean square distance between a detection in the turned frame and the detection turned (siamese)",
    "sigma_px": "what is added to positions (sigma) before they are judged, so that tiny shifts cannot tell the order",
    "motion_nats": "cross-entropy between the heat map and where the frame moves",
}
PHASE_MEANING = "start 0, start 1 …: short trainings from different weights; rest: the best of them trained on"


class Term(NamedTuple):
    """A word and what it means."""

    word: str
    meaning: str


def glossary(columns: Collection[str], losses: Collection[str]) -> list[Term]:
    """What needs words of the tables' `columns` and the curves' `losses` that the page shows, in their order."""
    headings = {**TRACKER_COLUMNS, **PREDICTOR_COLUMNS}
    of_columns = [Term(headings[key], meaning) for key, meaning in COLUMN_MEANINGS.items() if key in columns]
    of_losses = [Term(LOSSES[key], meaning) for key, meaning in LOSS_MEANINGS.items() if key in losses]
    phases = [Term("start, rest", PHASE_MEANING)] if of_losses else []
    return [*of_columns, *phases, *of_losses]
