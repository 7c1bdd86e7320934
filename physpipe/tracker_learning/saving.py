"""What a training of the tracker leaves behind: weights, curve, heat maps, verdict."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.io import results
from physpipe.io.atomic import replacing_folder
from physpipe.io.clips import ClipSet
from physpipe.io.pictures import save_png
from physpipe.tracker_learning.lesson import Learned
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracker_learning.snapshots import heat_sheet
from physpipe.trackers import detectors
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.signals import locked

CURVE, HEAT_MAPS, VERDICT = "curve.csv", "heatmaps.png", "verdict.json"


def save_first(out: Path, clips: ClipSet, learned: Learned, params: TrackerParams) -> None:
    """T1 with its curve, its verdict, and the heat maps of every start and of the end."""
    sheet = [*learned.starts, learned.net]
    _save(out, clips, [learned.net], sheet, learned.curve, [_judged(learned, params)])


def save_all(out: Path, clips: ClipSet, first: Path, others: Sequence[Learned], params: TrackerParams) -> None:
    """T1 from the folder `first` and the further objects' detectors, with their heat maps side by side."""
    nets = [*detectors.load(first / detectors.WEIGHTS), *(each.net for each in others)]
    judged = [*results.load_json(first / VERDICT)["objects"], *(_judged(each, params) for each in others)]
    curve = pd.concat([each.curve for each in others]) if others else pd.read_csv(first / CURVE)
    _save(out, clips, nets, nets, curve, judged)


def _judged(learned: Learned, params: TrackerParams) -> dict[str, Any]:
    signals = learned.signals
    return {"locked": locked(signals, params.lock), "score": signals.score(params.signals), **vars(signals)}


def _save(
    out: Path,
    clips: ClipSet,
    nets: Sequence[TrackNet],
    sheet: Sequence[TrackNet],
    curve: pd.DataFrame,
    objects: list[dict[str, Any]],
) -> None:
    """`locked` holds only when every object's detector is; `score` is the worst of theirs."""
    with replacing_folder(out) as folder:
        detectors.save(folder / detectors.WEIGHTS, nets)
        results.save_csv(folder / CURVE, curve)
        save_png(folder / HEAT_MAPS, heat_sheet(clips, sheet))
        worst = max(each["score"] for each in objects)
        verdict = {"locked": all(each["locked"] for each in objects), "score": worst, "objects": objects}
        results.save_json(folder / VERDICT, verdict)
