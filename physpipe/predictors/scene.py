"""What the seen frames and positions tell, as a tensor over the frame: the first state of the tensor nets.

All sizes are ours, and so is that the seen positions enter beside the frames, as marks and coordinates on the grid, and
that a frame seen at the end enters as what has changed in it.
"""

from dataclasses import dataclass

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.predictors.base import Seen
from physpipe.predictors.kinematics import SPEED, slope
from physpipe.predictors.layers import FrameUnit, bilinear_weights, everywhere, normed_conv, offsets_from


class SceneParams(Section):
    """Sizes of the first state (ours)."""

    stem: int = Field(ge=8, multiple_of=8)
    """Channels of the first convolution, at 1/4 of the frame's size."""
    channels: int = Field(ge=8, multiple_of=8)
    """Channels of the state, at 1/16 of the frame's size (8 x 8 for 128 px)."""
    objects_alike: bool
    """Whether objects share the weights that mark them (ours), so that permuting them permutes the forecast, or have
    channels of their own."""


@dataclass(frozen=True)
class Scene:
    """What is known when the propagation begins; lengths are in the unit of `FrameUnit`."""

    state: Tensor
    """(B, C, h, w)."""
    detail: Tensor
    """(B, C', 4 h, 4 w) of its first layer, which has seen frames alone."""
    whole: Tensor
    """(B, K, C) its mean."""
    places: Tensor
    """(B, T0, K, 2) seen positions."""
    times: Tensor
    """(B, S) frames since the first one seen."""
    unit: FrameUnit
    regressed: Tensor | None = None
    """(B, T0 + 1, K, 2) positions when seen and at the end, as the state tells them, where a net asks for them."""

    @property
    def grid(self) -> tuple[int, int]:
        """Cells down and across."""
        return self.state.shape[2], self.state.shape[3]

    @property
    def last_time(self) -> Tensor:
        """(B, 1) time of the last seen position."""
        return self.times[:, self.places.shape[1] - 1, None]


class SceneEncoder(nn.Module):
    """Stacked frames to 1/16 of their size, by convolutions of stride 4, 2 and 2, the objects joining at 1/4."""

    def __init__(self, params: SceneParams, objects: int, frames: int, seen_frames: int):
        """`frames` are looked at; in the first `seen_frames` of them the positions of `objects` are known."""
        super().__init__()
        C, self.objects, self.alike = params.channels, objects, params.objects_alike
        marked = (seen_frames + 4) * (1 if self.alike else objects)
        self.stem = normed_conv(3 * frames, params.stem, kernel=8, stride=4)
        self.middle = normed_conv(params.stem + marked, C, kernel=4, stride=2)
        self.top = nn.Sequential(normed_conv(C, C, kernel=4, stride=2), normed_conv(C, C, kernel=3, stride=1))

    def forward(self, seen: Seen) -> Scene:
        """The scene; `seen` may hold more frames than positions."""
        unit = FrameUnit.of(seen.frames)
        places = unit.from_px(seen.xy)
        known, end = seen.frames[:, : places.shape[1]], seen.frames[:, places.shape[1] :]
        stacked = torch.cat([known - 0.5, end - known[:, -1:]], dim=1).flatten(1, 2)
        low = self.stem(stacked.contiguous(memory_format=torch.channels_last))
        state = self._state(low, places, slope(places, seen.times[:, : places.shape[1]]), unit.aspect)
        whole = state.float().mean((2, 3)).unsqueeze(1).expand(-1, self.objects, -1)
        return Scene(state, low, whole, places, seen.times, unit)

    def _state(self, low: Tensor, places: Tensor, velocity: Tensor, aspect: Tensor) -> Tensor:
        """(B, C, h, w) from the frames' (B, stem, 4 h, 4 w)."""
        grid = (low.shape[2], low.shape[3])
        if self.alike:
            low = low.unsqueeze(1).expand(-1, self.objects, -1, -1, -1).flatten(0, 1)
            places, velocity = places.transpose(1, 2).flatten(0, 1).unsqueeze(2), apart(velocity)
        marks = bilinear_weights(places.flatten(1, 2), grid, aspect)
        offsets = offsets_from(places[:, -1], grid, aspect)
        middle = self.middle(torch.cat([low, marks, offsets, everywhere(velocity / SPEED, grid)], dim=1))
        return self.top(together(middle, self.objects) if self.alike else middle)


def apart(values: Tensor) -> Tensor:
    """(B K, 1, D): each object's `values` (B, K, D) as if it were alone."""
    return values.flatten(0, 1).unsqueeze(1)


def together(maps: Tensor, objects: int) -> Tensor:
    """(B, C, h, w): the mean over `objects` of the maps (B K, C, h, w) of each alone."""
    return maps.unflatten(0, (-1, objects)).mean(1)
