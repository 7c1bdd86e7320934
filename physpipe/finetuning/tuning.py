"""Tunes tracker and predictor together, and keeps them only where no figure known without labels got worse.

Ehrhardt et al. 2018 name this as future work (section 6); losses and gate are ours.
"""

import copy
from dataclasses import astuple, dataclass
from pathlib import Path

import pandas as pd
import torch
from pydantic import Field

from physpipe.core.determinism import device
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.finetuning.joint import AgreementParams, Joint
from physpipe.finetuning.stretches import Batch, Stretch, draw, evenly
from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams, Rank, fit
from physpipe.predictor_learning.predicting import calibrate
from physpipe.predictor_learning.windows import TrackWindows, WindowParams
from physpipe.predictors.base import Predictor, distance_px
from physpipe.tracker_learning.lesson import Lesson, lesson
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.signals import locked


class FinetuneParams(Section):
    """How tracker and predictor are tuned together."""

    agreement: AgreementParams
    held_out: int = Field(ge=1)
    """Stretches of the validation clips, evenly spread, on which both are judged."""
    fit: FitParams


@dataclass(frozen=True)
class State:
    """What is known of the two without labels, less is better, on the validation clips that chose their checkpoints."""

    unlocked: bool
    """Whether the tracker's own verdict is that it follows nothing."""
    score: float
    """The tracker's own: that which chooses among its starts and checkpoints."""
    tracker_px: float
    """Mean distance of what the detector finds from the refined tracks."""
    forecast_px: float
    """Mean distance of the forecasts from the refined tracks."""
    forecast_loss: float
    """What the predictor's own validation minimises."""


@dataclass(frozen=True)
class Tuned:
    """What tuning leaves: the two to use from now on, which are the former ones unless it gained."""

    net: TrackNet
    predictor: Predictor
    before: State
    after: State
    """Of the tuned two, shipped or not."""
    gained: bool
    curve: pd.DataFrame


def gained(after: State, before: State) -> bool:
    """Whether what was tuned is kept: it is locked, none of its figures is worse, and some are better."""
    no_worse = all(new <= old for new, old in zip(astuple(after), astuple(before), strict=True))
    return not after.unlocked and no_worse and after != before


def tune(
    clips: ClipSet,
    table: pd.DataFrame,
    nets: list[TrackNet],
    predictor: Predictor,
    horizon: int,
    mirrors: bool,
    tracker: TrackerParams,
    windows: WindowParams,
    params: FinetuneParams,
    seed: int,
    checkpoint: Path,
) -> Tuned:
    """Tunes copies of both on the training clips; `table` holds the unsupervised tracks, refined.

    `windows`: what the predictor is shown when it learns alone, mirrored or not as `mirrors` says. Raises InputError
    for several detectors of one object each, whose masks depend on each other.
    """
    if len(nets) > 1:
        reason = f"{len(nets)} detectors, each learned with the earlier ones' objects masked"
        raise InputError("params.yaml: run.finetuned", reason, "use `tracker.recipe: joint`: one detector finds all")
    net, size, looks = nets[0], params.fit.batch_size, params.agreement.looks
    seen, ends = predictor.seen_frames, predictor.sees_end
    alone = TrackWindows(clips, table, "train", seen, horizon, ends, predictor.steadies, mirrors)
    train = TrackWindows(clips, table, "train", seen, horizon, ends) if predictor.steadies else alone
    valid = TrackWindows(clips, table, "valid", seen, horizon, ends)
    held_out = evenly(valid, params.held_out, looks, size)
    task = lesson(clips, tracker)
    joint = Joint(copy.deepcopy(net), copy.deepcopy(predictor), params.agreement).to(device()).eval()
    before = _state(joint, task, held_out)

    def sample(generator: torch.Generator) -> Batch:
        return Batch(task.train(generator), alone.draw(size, windows, generator), draw(train, size, looks, generator))

    def rank() -> Rank:
        now = _state(joint, task, held_out)
        return not gained(now, before), now.tracker_px / before.tracker_px + now.forecast_px / before.forecast_px

    curve = fit(joint, sample, rank, params.fit, seed, checkpoint, "tuning together")
    after = _state(joint, task, held_out)
    calibrate(joint.predictor, clips, table, valid, windows.valid_windows)
    better = gained(after, before)
    return Tuned(*((joint.net, joint.predictor) if better else (net, predictor)), before, after, better, curve)


@torch.no_grad()
def _state(joint: Joint, task: Lesson, held_out: list[Stretch]) -> State:
    signals = task.read(joint.net)
    found = torch.cat([distance_px(joint.find(each)[1], each.xy) for each in held_out])
    forecast = torch.cat([distance_px(joint.forecast(each), each.xy) for each in held_out])
    losses = [len(each.frames) * joint.predictor.validation_loss(each.window) for each in held_out]
    loss = float(sum(losses)) / sum(len(each.frames) for each in held_out)
    score, unlocked = signals.score(task.signals), not locked(signals, task.lock)
    return State(unlocked, score, found.mean().item(), forecast.mean().item(), loss)
