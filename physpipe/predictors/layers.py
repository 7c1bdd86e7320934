"""Pieces of networks whose state is a grid over the frame."""

import torch
from torch import Tensor, nn

GROUPS = 8
"""Groups of every group normalisation; widths are multiples of it."""


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

    `place` (B, M, 2): (x, y) from the frame's centre, 1 being half of the frame's longer side; `aspect` (2,):
    the frame's (width, height) in that unit, at most 2. Weights rather than `grid_sample`, whose gradient has no
    deterministic kernel on the GPU; the same weights mark a place on the grid.
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
