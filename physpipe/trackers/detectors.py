"""Files of trained trackers T1 ... TK, and the track table that they make."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from physpipe.core.progress import progress
from physpipe.io import checkpoints, tracks
from physpipe.io.clips import ClipSet
from physpipe.trackers.learned import LearnedTracker, ReadoutParams
from physpipe.trackers.sequential import MaskParams, SequentialTracker
from physpipe.tracknet.model import TrackNet, TrackNetParams

WEIGHTS = "weights.pt"
"""File of the weights in a training's folder."""


def save(path: Path, nets: Sequence[TrackNet]) -> None:
    """Writes T1 ... TK with what is needed to build them again."""
    states = [{name: value.cpu() for name, value in each.state_dict().items()} for each in nets]
    about = {"params": nets[0].params.model_dump(), "frame_size": nets[0].judge.frame_size}
    checkpoints.save(path, {**about, "nets": states})


def load(path: Path) -> list[TrackNet]:
    """T1 ... TK; raises InputError for a file that holds none."""
    saved = checkpoints.load(path)
    nets = []
    for state in saved["nets"]:
        net = TrackNet(TrackNetParams.model_validate(saved["params"]), saved["frame_size"])
        checkpoints.load_into(net, state, path)
        nets.append(net)
    return nets


def together(nets: Sequence[TrackNet], readout: ReadoutParams, mask: MaskParams) -> SequentialTracker:
    """T1 ... TK as one tracker of K objects."""
    return SequentialTracker([LearnedTracker(each.detector, readout) for each in nets], mask)


def track_table(clips: ClipSet, tracker: SequentialTracker) -> pd.DataFrame:
    """THE track table of every clip; object k is what detector k finds, hence the same through a clip."""
    tables = []
    for name in progress(clips.names(), "tracking clips"):
        found = tracker.track_all(clips.frames(name))
        xy = np.stack([each.xy for each in found], axis=1)
        score = np.stack([each.score for each in found], axis=1)
        tables.append(tracks.rows(name, clips.times_s(name), xy, score))
    return pd.concat(tables, ignore_index=True)
