"""What tuning together leaves behind."""

from dataclasses import asdict
from pathlib import Path

from physpipe.finetuning.tuning import State, Tuned
from physpipe.io import results
from physpipe.io.atomic import replacing_folder
from physpipe.predictor_learning.predicting import LearnedParams, save_predictor
from physpipe.trackers import detectors

VERDICT, PREDICTOR = "verdict.json", "predictor"


def save_tuned(out: Path, tuned: Tuned, name: str, params: LearnedParams) -> None:
    """The detector as a tracker's training leaves it, in `predictor` that of the name, and a verdict on both."""
    with replacing_folder(out) as folder:
        detectors.save(folder / detectors.WEIGHTS, [tuned.net])
        save_predictor(folder / PREDICTOR, name, tuned.predictor, params, tuned.curve)
        results.save_json(folder / VERDICT, _verdict(tuned))


def _verdict(tuned: Tuned) -> dict[str, object]:
    """`locked` and `score` as of any tracker, of what is shipped; and the gate's figures before and after."""
    shipped = tuned.after if tuned.gained else tuned.before
    states: dict[str, State] = {"before": tuned.before, "after": tuned.after}
    return {
        "locked": not shipped.unlocked,
        "score": shipped.score,
        "gained": tuned.gained,
        **{when: asdict(state) for when, state in states.items()},
    }
