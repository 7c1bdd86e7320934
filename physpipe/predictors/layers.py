"""Pieces of networks whose state is a grid over the frame."""

from collections.abc import Callable
from typing import NamedTuple

import torch
from torch import Tensor, nn

GROUPS = 8
"""Groups of every group normalisation; widths are multiples of it."""


class FrameUnit(NamedTuple):
    """The networks' unit of length, half of the frame's longer side, from the frame's centre."""

    px: Tensor
    """() length of the unit in pixels."""
    centre: Tensor
    """(2,) pixels."""
    aspect: Tensor
    """(2,) the frame's (width, height) in the unit, at most 2."""

    @classmethod
    def of(cls, frames: Tensor) -> "FrameUnit":
        """The unit for `frames` (..., H, W)."""
        size = torch.tensor(frames.shape[:-3:-1], device=frames.device)
        px = size.max() / 2
        return cls(px, (size - 1) / 2, size / px)

    def from_px(self, xy: Tensor) -> Tensor:
        """Pixels (..., 2) in the unit."""
        return (xy - self.centre) / self.px

    def to_px(self, place: Tensor) -> Tensor:
        """The inverse of `from_px`."""
        return place * self.px + self.centre


def normed_conv(inputs: int, outputs: int, kernel: int, stride: int) -> nn.Sequential:
    """Convolution, group norm, ReLU; the output has 1/stride of the input's size (rounded down)."""
    conv = nn.Conv2d(inputs, outputs, kernel, stride, padding=(kernel - stride + 1) // 2)
    return nn.Sequential(conv, nn.GroupNorm(GROUPS, outputs), nn.ReLU())


class Residual(nn.Module):
    """state + conv(ReLU(norm(conv(state) + extra))), both 3x3."""

    def __init__(self, channels: int):
        super().__init__()
        self.first = nn.Conv2d(channels, channels, 3, padding=1)
        self.norm = nn.GroupNorm(GROUPS, channels)
        self.second = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, state: Tensor, extra: Tensor) -> Tensor:
        """`state`, `extra`: (B, C, h, w)."""
        return state + self.second(torch.relu(self.norm(self.first(state) + extra)))


def bilinear_weights(place: Tensor, grid: tuple[int, int], aspect: Tensor) -> Tensor:
    """(B, M, h, w) share of each grid cell in the value at `place`; sums to 1, the edge going on outside.

    `place` (B, M, 2) and `aspect` (2,) are in the unit of `FrameUnit`. Weights rather than `grid_sample`, whose
    gradient has no deterministic kernel on the GPU; the same weights mark a place on the grid.
    """
    near = []
    for axis, cells in ((1, grid[0]), (0, grid[1])):
        wanted = (place[..., axis] / aspect[axis] + 0.5) * cells - 0.5
        wanted = wanted.clamp(0, cells - 1).unsqueeze(-1)
        near.append(torch.relu(1 - (torch.arange(cells, device=place.device) - wanted).abs()))
    return near[0].unsqueeze(-1) * near[1].unsqueeze(-2)


def offsets_from(place: Tensor, grid: tuple[int, int], aspect: Tensor) -> Tensor:
    """(B, 2 M, h, w): x, then y, from each of `place` (B, M, 2) to each cell's centre, in the same unit."""
    spans = []
    for axis, cells in ((0, grid[1]), (1, grid[0])):
        centres = (torch.arange(cells, device=place.device) + 0.5) / cells - 0.5
        spans.append(centres * aspect[axis] - place[..., axis, None])
    across = spans[0].unsqueeze(-2).expand(-1, -1, *grid)
    down = spans[1].unsqueeze(-1).expand(-1, -1, *grid)
    return torch.cat([across, down], dim=1)


def read_at(field: Tensor, weights: Tensor) -> Tensor:
    """(B, M, C) values of `field` (B, C, h, w) at the M places of `bilinear_weights`."""
    return torch.einsum("bchw,bmhw->bmc", field.float(), weights)


def everywhere(values: Tensor, grid: tuple[int, int]) -> Tensor:
    """(B, M D, h, w) maps that hold each of `values` (B, M, D) everywhere."""
    return values.flatten(1)[:, :, None, None].expand(-1, -1, *grid)


class Locator(nn.Module):
    """Positions regressed from a state: where its cells point to, weighted by how well each matches a query.

    Cells point to their own centres before they have learned anything.
    """

    def __init__(self, channels: int):
        super().__init__()
        self.point = nn.Conv2d(channels, 2, 1)
        for each in self.point.parameters():
            nn.init.zeros_(each)

    def forward(self, state: Tensor, queries: Tensor, aspect: Tensor) -> Tensor:
        """(B, M, 2) in the unit of `FrameUnit`; `state` (B, C, h, w), `queries` (B, M, C)."""
        grid = (state.shape[2], state.shape[3])
        match = torch.einsum("bmc,bchw->bmhw", queries, state).float()  # over sqrt(C) it would take long to sharpen
        centres = offsets_from(torch.zeros(len(state), 1, 2, device=state.device), grid, aspect)
        pointed = centres + self.point(state).float()  # (B, 2, h, w)
        share = match.flatten(2).softmax(2).unsqueeze(2)  # no matrix product below: autocast would round positions
        return (share * pointed.flatten(2).unsqueeze(1)).sum(3)


def reader(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    """Perceptron of one hidden layer."""
    return nn.Sequential(nn.Linear(inputs, hidden), nn.ReLU(), nn.Linear(hidden, outputs))


def zero_reader(inputs: int, hidden: int, outputs: int, activation: Callable[[], nn.Module] = nn.ReLU) -> nn.Sequential:
    """Perceptron of two hidden layers that answers 0 before it has learned anything."""
    last = zero_linear(hidden, outputs)
    layers = [nn.Linear(inputs, hidden), activation(), nn.Linear(hidden, hidden), activation()]
    return nn.Sequential(*layers, last)


def zero_linear(inputs: int, outputs: int, bias: bool = True) -> nn.Linear:
    """Layer that answers 0 before it has learned anything."""
    layer = nn.Linear(inputs, outputs, bias)
    for each in layer.parameters():
        nn.init.zeros_(each)
    return layer
