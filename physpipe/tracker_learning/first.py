"""Learns the first detector: several short starts, of which the best goes on."""

from pathlib import Path

import pandas as pd
import torch

from physpipe.core.determinism import ComputeParams, torch_generator
from physpipe.io.clips import ClipSet, common_size
from physpipe.tracker_learning.lesson import Learned, copied, lesson
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracknet.model import TrackNet


def learn_first(clips: ClipSet, params: TrackerParams, compute: ComputeParams, scratch: Path) -> Learned:
    """T1: `starts` short trainings, then the rest of the training for the best of them, unless that spoils it."""
    recipe = params.chosen()
    task = lesson(clips, params)
    nets, curves = [], []
    for number in range(recipe.starts):
        torch.manual_seed(int(torch.randint(2**31, (), generator=torch_generator(compute.seed, number))))
        net = TrackNet(recipe.net, max(common_size(clips)))
        seed = 1000 * compute.seed + number
        curves.append(task.run(net, recipe.start, seed, scratch / f"start{number}.pt", f"start {number}"))
        nets.append(net)
    start = min(nets, key=task.rank)
    trained = copied(start)
    curves.append(task.run(trained, recipe.rest, 1000 * compute.seed + 999, scratch / "rest.pt", "rest"))
    best = min((trained, start), key=task.rank)
    return Learned(best, pd.concat(curves), task.read(best), nets)
