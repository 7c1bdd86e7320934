"""A small tracker that has locked on a ball, its tracks, and a small predictor, to be tuned together."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest
import torch
from small_tracker import orbits, params
from springs import STATE

from physpipe.core.determinism import ComputeParams
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.predictors.base import Predictor
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.tensor_state import TensorStateParams
from physpipe.tracker_learning.first import learn_first
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracknet.model import TrackNet


@dataclass(frozen=True)
class Pair:
    """What fine-tuning starts from."""

    clips: ClipSet
    table: pd.DataFrame
    net: TrackNet
    predictor: Predictor
    tracker: TrackerParams


@pytest.fixture(scope="session")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Pair:
    folder = tmp_path_factory.mktemp("pair")
    tracker = params(steps=80, warm=60, rest=5, several=True)
    clips, truth = orbits(folder / "clips")
    net = learn_first(clips, tracker, ComputeParams(seed=0, threads=1), folder / "scratch").net
    # Discs are so plain that refined tracks would be where they are drawn
    refined = [tracks.rows(name, clips.times_s(name), xy, np.ones(xy.shape[:2])) for name, xy in truth.items()]
    small = TensorStateParams(**STATE | {"symmetric": False})
    torch.manual_seed(0)
    return Pair(clips, pd.concat(refined), net, DispNet(small, 1).eval(), tracker)
