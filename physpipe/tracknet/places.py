"""Where objects are in a heat map: one place for the whole map (paper section 3.1), or one at each peak (ours)."""

from itertools import permutations
from typing import NamedTuple

import torch
import torch.nn.functional as F
from pydantic import Field, field_validator
from torch import Tensor

from physpipe.core.params import Section
from physpipe.tracknet.heatmap import cell_centres, entropy, expected_position


class PeakParams(Section):
    """How several objects are told apart in one heat map, their number not given."""

    slots: int = Field(ge=1, le=5)
    """Most objects that are sought in a frame."""
    apart_px: float = Field(gt=0)
    """Least distance between two peaks; about an object's diameter."""
    window_px: float = Field(gt=0)
    """Radius around a peak within which the mean position is taken."""
    least_mass: float = Field(gt=0, lt=1)
    """Share of the heat map that a peak must hold to be an object."""
    even: float = Field(gt=0, le=1)
    """Share of the strongest motion at which a peak counts half, so that faint objects are learned, too."""
    nearby_cells: int = Field(ge=1)
    """Side of the square of cells within which motion is compared, odd: about an object and its surroundings."""

    @field_validator("nearby_cells")
    @classmethod
    def _odd(cls, cells: int) -> int:
        if cells % 2 == 0:
            raise ValueError("must be odd, so that a cell stands in the middle")
        return cells


class Places(NamedTuple):
    """K places in each of B heat maps."""

    xy: Tensor
    """(B, K, 2) pixels."""
    mass: Tensor
    """(B, K) share of the heat map that speaks for each."""
    spread: Tensor
    """(B, K) entropy in nats of that share, taken as a distribution of its own."""


def whole(heat: Tensor, stride: int) -> Places:
    """The paper's one place: u = sum_v v s_v over all of (B, h, w)."""
    mass = torch.ones(len(heat), 1).to(heat)
    return Places(expected_position(heat, stride)[:, None], mass, entropy(heat)[:, None])


@torch.no_grad()
def peaks(heat: Tensor, stride: int, params: PeakParams) -> Tensor:
    """(B, slots, 2) pixels of the highest local maxima of (B, h, w) that lie apart, the highest first."""
    highest_near = F.max_pool2d(heat[:, None], 3, stride=1, padding=1)[:, 0]
    grid, left, found = _grid(heat, stride), torch.where(heat == highest_near, heat, 0), []
    for _ in range(params.slots):
        highest = grid.view(-1, 2)[left.flatten(1).argmax(1)]
        found.append(highest)
        apart = (grid - highest[:, None, None]).square().sum(-1)
        left = left.masked_fill(apart < params.apart_px**2, -1)
    return torch.stack(found, 1)


def around(heat: Tensor, stride: int, centres: Tensor, window_px: float) -> Places:
    """A place near each of (B, K, 2) `centres`: the mean over the cells in its window that no other centre is nearer
    to."""
    grid = _grid(heat, stride)
    squared = (grid - centres[:, :, None, None]).square().sum(-1)  # (B, K, h, w)
    nearest = squared.argmin(1, keepdim=True) == torch.arange(centres.shape[1], device=heat.device)[:, None, None]
    own = (squared <= window_px**2) & nearest
    part = heat[:, None] * own
    mass = part.flatten(2).sum(2)
    share = part / mass.clamp_min(1e-12)[..., None, None]
    xy = (share[..., None] * grid).flatten(2, 3).sum(2)
    return Places(xy, mass.clamp_max(1), entropy(share.flatten(0, 1)).view(mass.shape))


@torch.no_grad()
def linked(xy: Tensor) -> Tensor:
    """(B, T, K) numbers of the places that follow each other, for (B, T, K, 2): at each moment the assignment to the
    moment before that moves least in all."""
    B, T, K = xy.shape[:3]
    orders = torch.tensor(list(permutations(range(K))), device=xy.device)
    chosen = [torch.arange(K, device=xy.device).expand(B, K)]
    for moment in range(1, T):
        before = taken(xy[:, moment - 1], chosen[-1])
        moves = (before[:, :, None] - xy[:, moment, None]).norm(dim=-1)  # (B, K before, K now)
        costs = torch.stack([moves[:, range(K), order].sum(1) for order in orders], 1)
        chosen.append(orders[costs.argmin(1)])
    return torch.stack(chosen, 1)


def taken(xy: Tensor, order: Tensor) -> Tensor:
    """(..., K, 2) places in the order (..., K)."""
    return xy.gather(-2, order[..., None].expand(*order.shape, 2))


def _grid(heat: Tensor, stride: int) -> Tensor:
    """(h, w, 2) pixel coordinates of the cells of (B, h, w)."""
    xs, ys = (cell_centres(count, stride).to(heat) for count in (heat.shape[2], heat.shape[1]))
    return torch.stack(torch.meshgrid(xs, ys, indexing="xy"), -1)
