"""CorrFlow: a flow network of FlowNet's family, after PWC-Net (Sun et al. 2018); all sizes are ours.

Small fast balls vanish on a coarse grid, so the matching radius of the middle level alone spans the largest motion.
"""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from pydantic import Field, field_validator, model_validator
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.flownet.layers import Level, contrast, features
from physpipe.flownet.matching import convex_upsample, enlarged


class CorrFlowParams(Section):
    """Size of the network, and what it is taught."""

    channels: list[int] = Field(min_length=2)
    """Channels of the features at stride 2, 4, 8, ..., finest first."""
    radii: list[int] = Field(min_length=2)
    """Cells to each side within which a level looks for a match, finest first."""
    decoder: int = Field(ge=8)
    """Channels of the layers that read a level's matches."""
    contrast_px: int = Field(ge=3)
    """Side of the window around a pixel to which its brightness is relative; odd."""
    inside_weight: float = Field(ge=0)
    """Weight of the mean error inside the objects, which cover few pixels; that of the rest is 1."""
    level_weight: float = Field(ge=0)
    """Weight of a level's error over the next finer one's."""

    @field_validator("contrast_px")
    @classmethod
    def _has_a_middle(cls, contrast_px: int) -> int:
        if contrast_px % 2 == 0:
            raise ValueError("is even, so that no pixel lies in its middle")
        return contrast_px

    @model_validator(mode="after")
    def _a_radius_a_level(self) -> "CorrFlowParams":
        if len(self.channels) != len(self.radii):
            raise ValueError(f"{len(self.channels)} levels of channels, {len(self.radii)} radii")
        return self


class FlowPairs(NamedTuple):
    """Two pictures each of B scenes, and the exact flow between them."""

    first: Tensor
    """(B, 3, H, W) in [0, 1]."""
    second: Tensor
    """(B, 3, H, W) in [0, 1]."""
    flow: Tensor
    """(B, 2, H, W) pixels (x, y) from the first to the second."""
    inside: Tensor
    """(B, H, W) bool: pixels of a moving object in the first."""


class CorrFlow(nn.Module):
    """Flow from one picture to the next, coarse to fine."""

    def __init__(self, params: CorrFlowParams):
        super().__init__()
        self.params = params
        inputs = [3, *params.channels[:-1]]
        pairs = zip(inputs, params.channels, strict=True)
        self.pyramid = nn.ModuleList(features(i, o) for i, o in pairs)
        sizes = list(zip(params.channels, params.radii, strict=True))
        coarser = [*[params.decoder] * (len(sizes) - 1), 0]  # the coarsest level has none above it
        self.levels = nn.ModuleList(
            Level(channels, radius, params.decoder, above)
            for (channels, radius), above in zip(sizes, coarser, strict=True)
        )
        self.upsampling = nn.Conv2d(params.decoder, 36, 1)

    def forward(self, first: Tensor, second: Tensor) -> Tensor:
        """(B, 2, H, W) pixels (x, y) from `first` to `second`, (B, 3, H, W) in [0, 1], of any H and W."""
        return self._estimates(first, second)[-1]

    def loss(self, batch: FlowPairs, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean endpoint error outside the objects and, weighted, inside, over all levels, in pixels."""
        estimates = self._estimates(batch.first, batch.second)
        errors = [endpoint_errors(each, batch) for each in reversed(estimates)]  # finest first
        weighed = [self.params.level_weight**n * _weighed(error, self.params) for n, error in enumerate(errors)]
        outside, inside = (each.item() for each in errors[0])
        return torch.stack(weighed).sum(), {"outside_px": outside, "inside_px": inside}

    def _estimates(self, first: Tensor, second: Tensor) -> list[Tensor]:
        """The flow (B, 2, H, W) as each level knows it, coarsest first; the last is the sharp one."""
        height, width = first.shape[2:]
        step = 2 ** len(self.levels)
        margin = (0, -width % step, 0, -height % step)
        both = F.pad(contrast(torch.cat([first, second]), self.params.contrast_px), margin, mode="replicate")
        maps = []
        for part in self.pyramid:
            both = part(both)
            maps.append(both.chunk(2))
        flow, state, estimates = None, None, []
        for number in reversed(range(len(self.levels))):
            flow, state = self.levels[number](*maps[number], flow, state, 2 ** (number + 1))
            estimates.append(enlarged(flow, 2 ** (number + 1)))
        assert flow is not None  # there are at least two levels
        estimates[-1] = convex_upsample(flow, self.upsampling(state))
        return [each[:, :, :height, :width] for each in estimates]


def endpoint_errors(flow: Tensor, batch: FlowPairs) -> Tensor:
    """(2,) mean distance of `flow` from the truth, in pixels: outside the objects, inside (0 where there are none)."""
    apart = (flow - batch.flow).square().sum(1).add(1e-6).sqrt()  # smooth at 0
    counted = [~batch.inside, batch.inside]
    return torch.stack([(apart * part).sum() / part.sum().clamp_min(1) for part in counted])


def _weighed(errors: Tensor, params: CorrFlowParams) -> Tensor:
    return errors[0] + params.inside_weight * errors[1]
