"""Learned flow for the dense-flow trackers: what FlowNet 2 is in the paper, whose weights are not to be had."""

from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.flownet import weights
from physpipe.flownet.inference import flows

FLOW_TRACKERS = ("flow_simple", "flow_blob")
"""Members of BASELINES that follow a learned flow."""


class LearnedFlowParams(Section):
    """How a trained network is run."""

    batch_pairs: int = Field(ge=1)
    """Pairs of frames per forward pass; bounds the memory."""


class LearnedFlow:
    """A trained CorrFlow as a dense flow between frames; crosses process pools."""

    def __init__(self, folder: Path, params: LearnedFlowParams):
        """Raises InputError when `folder` holds no trained network."""
        self.net, self.params, self.threads = weights.load(folder), params, torch.get_num_threads()

    def __setstate__(self, state: dict[str, Any]) -> None:
        """In a worker process: with as many threads as the parent has, since another number rounds otherwise."""
        self.__dict__.update(state)
        torch.set_num_threads(self.threads)

    def __call__(self, first: NDArray[np.uint8], second: NDArray[np.uint8]) -> NDArray[np.float32]:
        """(H, W, 2) pixels (x, y) from `first` to `second`, both (H, W, 3) RGB."""
        return next(flows(self.net, first[None], second[None], 1))

    def of_clip(self, frames: NDArray[np.uint8]) -> NDArray[np.float32]:
        """(T - 1, H, W, 2) flow from each of (T, H, W, 3) frames to the next, in batches."""
        found = list(flows(self.net, frames[:-1], frames[1:], self.params.batch_pairs))
        return np.array(found, np.float32).reshape(-1, *frames.shape[1:3], 2)
