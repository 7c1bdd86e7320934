"""What tuning together leaves behind."""

from dataclasses import asdict
from pathlib import Path

from physpipe.finetuning.tuning import State, Tuned
from physpipe.io import results
from physpipe.io.atomic import replacing_folder
from physpipe.predictor_learning.predicting import CURVE, LearnedParams, save_weights
from physpipe.trackers import detectors

VERDICT, PREDICTOR = "verdict.json", "predictor"


def save_tuned(out: Path, tuned: Tuned, name: str, params: LearnedParams) -> None:
    """The detector as a tracker's training leaves it, in `predictor` that of the name, curve and verdict of both."""
    with replacing_folder(out) as folder:
        detectors.save(folder / detectors.WEIGHTS, [tuned.net])
        save_weights(folder / PREDICTOR, name, tuned.predictor, params)
        results.save_csv(folder / CURVE, tuned.curve)
        results.save_json(folder / VERDICT, _verdict(tuned))


def _verdict(tuned: Tuned) -> dict[str, object]:
    """`locked` and `score` as of any tracker, of what is kept; `tracks`, how many a clip has; the gate's figures."""
    kept = tuned.after if tuned.gained else tuned.before
    states: dict[str, State] = {"before": tuned.before, "after": tuned.after}
    return {
        "locked": not kept.unlocked,
        "score": kept.score,
        "gained": tuned.gained,
        "tracks": tuned.predictor.objects,
        **{when: asdict(state) for when, state in states.items()},
    }
