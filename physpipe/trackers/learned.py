"""The unsupervised detector as a tracker: heat maps of all frames, read out as positions."""

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field
from torch import Tensor

from physpipe.core.determinism import device
from physpipe.core.params import Section
from physpipe.core.precision import brief
from physpipe.trackers.base import Trajectory
from physpipe.tracknet.detector import Detector
from physpipe.tracknet.heatmap import cell_centres, distribution, expected_position
from physpipe.tracknet.moments import masked


class ReadoutParams(Section):
    """How a position is read off a heat map."""

    window_px: float = Field(gt=0)
    """Radius around the highest cell within which the mean position is taken; a frame's size = all (paper)."""
    batch_frames: int = Field(ge=1)
    """Frames per forward pass; bounds the memory."""


class LearnedTracker:
    """One detector; finds its object alone, needs no start."""

    def __init__(self, detector: Detector, params: ReadoutParams):
        self.detector = detector.to(device=device(), memory_format=torch.channels_last).eval()  # type: ignore[call-overload]
        self.params = params

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """Positions in (T, H, W, 3) frames; the score is the share of the heat map within the window."""
        parts = [readout(heat, self.detector.stride, self.params.window_px) for heat in self.heat_maps(frames, ignore)]
        xy, score = (torch.cat(each).cpu().numpy() for each in zip(*parts, strict=True))
        return Trajectory(xy, score)

    @torch.no_grad()
    def heat_maps(self, frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None = None) -> Iterator[Tensor]:
        """(B, h, w) probabilities, batch after batch."""
        for first in range(0, len(frames), self.params.batch_frames):
            part = slice(first, first + self.params.batch_frames)
            images = torch.from_numpy(np.array(frames[part])).to(device()).movedim(-1, 1)
            hidden = (
                None if ignore is None else torch.from_numpy(cells(ignore[part], self.detector.stride)).to(device())
            )
            with brief():
                logits = self.detector(images.float() / 255)
            yield distribution(masked(logits, hidden))


def readout(heat: Tensor, stride: int, window_px: float) -> tuple[Tensor, Tensor]:
    """(B, h, w) probabilities to (B, 2) pixels and the (B,) share of each map that lies within the window."""
    peak = heat.flatten(1).argmax(1)
    rows, columns = peak // heat.shape[2], peak % heat.shape[2]
    xs, ys = (cell_centres(count, stride).to(heat) for count in (heat.shape[2], heat.shape[1]))
    apart = (xs - xs[columns][:, None]).square()[:, None, :] + (ys - ys[rows][:, None]).square()[:, :, None]
    near = heat * (apart <= window_px**2)
    mass = near.flatten(1).sum(1)
    return expected_position(near / mass[:, None, None], stride), mass.clamp_max(1)  # rounding may add up to more


def cells(ignore: NDArray[np.bool_], stride: int) -> NDArray[np.bool_]:
    """(T, H, W) pixels to (T, h, w) heat-map cells: each is what its middle pixel is."""
    height, width = (size // stride * stride for size in ignore.shape[1:])
    return ignore[:, stride // 2 : height : stride, stride // 2 : width : stride]
