"""One training of one detector: what it learns from, and what came of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.determinism import torch_generator
from physpipe.core.precision import brief
from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams, Rank, fit
from physpipe.tracker_learning.moments import MomentSampler
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.moments import Moments
from physpipe.tracknet.signals import LockParams, SignalParams, Signals, locked, read_signals


@dataclass(frozen=True)
class Lesson:
    """Everything that a training of one detector needs beside the network."""

    train: MomentSampler
    held_out: list[Moments]
    signals: SignalParams
    lock: LockParams

    def read(self, net: TrackNet) -> Signals:
        """Signals on the held-out batches; the same noise for every network and time."""
        with brief():
            return read_signals(net.eval(), self.held_out, self.signals, torch_generator(0))

    def rank(self, net: TrackNet) -> Rank:
        """Lower is better: the unsupervised score, but one that is not locked never stands before one that is."""
        signals = self.read(net)
        return not locked(signals, self.lock), signals.score(self.signals)

    def run(self, net: TrackNet, params: FitParams, seed: int, checkpoint: Path, what: str) -> pd.DataFrame:
        """Trains `net` and returns its curve; it is left with the weights of the lowest rank."""
        curve = fit(net, self.train, lambda: self.rank(net), params, seed, checkpoint, what)
        return curve.assign(phase=what)


@dataclass(frozen=True)
class Learned:
    """A trained network, how it got there, and what is known of it without labels."""

    net: TrackNet
    curve: pd.DataFrame
    signals: Signals
    starts: list[TrackNet]
    """The network at the end of each start, the chosen one included."""


Ignored = Mapping[str, NDArray[np.bool_]]


def lesson(clips: ClipSet, params: TrackerParams, ignored: Ignored | None = None) -> Lesson:
    """Moments of the training clips to learn from and of the validation clips to judge by."""
    recipe = params.chosen()
    train = MomentSampler(clips, clips.names("train"), recipe.moments, recipe.rest.batch_size, ignored)
    valid = MomentSampler(clips, clips.names("valid"), recipe.moments, recipe.rest.batch_size, ignored)
    held_out = [valid(torch_generator(1, number)) for number in range(params.signals.batches)]
    return Lesson(train, held_out, params.signals, params.lock)


def copied(net: TrackNet) -> TrackNet:
    """A network with the same weights, to be learned further by itself."""
    twin = TrackNet(net.params, net.judge.frame_size)
    twin.load_state_dict(net.state_dict())
    return twin
