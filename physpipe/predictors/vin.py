"""VIN, the Visual Interaction Network: from film alone to one state code an object, and from codes to positions.

Watters et al. 2017 (arXiv 1706.01433), on 32 x 32 frames as there and in Ehrhardt et al. 2018, section 3.2. Two
consecutive frames, with the coordinates of each pixel, are encoded into a part of a code for each object; the parts of
three consecutive frames make the object's code, so that six frames give four. Three interaction cores foresee the next
code from the codes 1, 2 and 4 frames before it, an aggregator makes one of the three, and so on; one linear layer
decodes any code into position and velocity. The codes of the seen frames are decoded and learned from as well (the
auxiliary loss). Ours: all widths and the plain stack of convolutions; every frame weighs the same in the loss, where
theirs discounts; errors are distances in pixels.

Objects are slots, the n-th of which learns to be the n-th object of the tracks by its looks. The seen positions are
not looked at, so their order changes no forecast, and a forecast is as good as the film tells the objects apart.
"""

from typing import NamedTuple

import torch
from pydantic import Field
from torch import Tensor, nn
from torch.nn import functional

from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen, Window, distance_px
from physpipe.predictors.interaction import InteractionCore, perceptron, xavier
from physpipe.predictors.kinematics import SPEED, at
from physpipe.predictors.layers import FrameUnit

SIDE = 32
"""Pixels to which frames are shrunk, whatever their shape."""
OFFSETS = (1, 2, 4)
"""Frames that the cores look back."""
SEEN_FRAMES, CODED = 6, 4
"""Frames seen, and those of them that have a code: each has that is the last of three."""
LARGEST = 1e3
"""Largest entry of a code: one that runs away far beyond the horizon stays finite."""


class VinParams(Section):
    """Sizes of the network and weights of what it learns from (ours)."""

    channels: int = Field(ge=1)
    """Channels of the first convolution; the last ones have four times as many."""
    code: int = Field(ge=1)
    """Length of an object's state code."""
    hidden: int = Field(ge=1)
    """Width of all perceptrons."""
    seen_weight: float = Field(ge=0)
    """Weight in the loss of the error at the seen frames, over that at the frames asked for."""
    velocity_weight: float = Field(ge=0)
    """Weight in the loss of the error of the velocity (pixels a frame), over that of the position (pixels)."""


class Motion(NamedTuple):
    """What codes are decoded into."""

    xy: Tensor
    """(B, N, K, 2) pixels."""
    velocity: Tensor
    """(B, N, K, 2) pixels a frame."""


class Vin(Predictor):
    """Any number of objects; frames of any shape; asked times are whole frames after the last seen."""

    Params = VinParams
    seen_frames = SEEN_FRAMES

    def __init__(self, params: VinParams, objects: int):
        super().__init__(params, objects)
        self.seen_weight, self.velocity_weight = params.seen_weight, params.velocity_weight
        C = params.channels
        pair = _encoder(inputs=8, widths=(C, 2 * C, 2 * C, 4 * C, 4 * C))  # 2 x RGB, x and y
        self.encode = nn.Sequential(pair, xavier(nn.Linear(4 * C, objects * params.code)))
        self.merge = perceptron(2 * params.code, params.hidden, params.code)
        self.cores = nn.ModuleList(InteractionCore(params.code, params.hidden, params.code) for _ in OFFSETS)
        self.aggregate = perceptron(len(OFFSETS) * params.code, params.hidden, params.code)
        self.decode = xavier(nn.Linear(params.code, 4))

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        return Forecast(self._motion(seen, asked_times)[1].xy)

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean distance from the target in pixels, and by weight: from the seen positions, and from all velocities.

        True velocities are the differences of the positions one after the other.
        """
        seen, asked = self._motion(batch.seen, batch.asked_times)
        distance = distance_px(asked.xy, batch.target)
        seen_px = distance_px(seen.xy, batch.seen.xy[:, -CODED:]).mean()
        known = torch.cat([batch.seen.xy[:, -CODED - 1 :], batch.target], dim=1)
        times = torch.cat([batch.seen.times[:, -CODED - 1 :], batch.asked_times], dim=1)
        velocity = known.diff(dim=1) / times.diff(dim=1)[..., None, None]
        astray = distance_px(torch.cat([seen.velocity, asked.velocity], dim=1), velocity).mean()
        loss = distance.mean() + self.seen_weight * seen_px + self.velocity_weight * astray
        return loss, {"train_last_px": distance[:, -1].mean().item(), "train_seen_px": seen_px.item()}

    def _motion(self, seen: Seen, asked_times: Tensor) -> tuple[Motion, Motion]:
        """At the last four seen frames, and at those asked for."""
        ahead = (asked_times - seen.times[:, -1:]).long()  # (B, N) steps from the last seen frame
        codes = self._roll(self._codes(seen.frames), int(ahead.max()))
        decoded = self.decode(torch.cat([codes[:, :CODED], at(codes[:, CODED:], ahead)], dim=1)).float()
        unit = FrameUnit.of(seen.frames)
        motion = Motion(unit.to_px(decoded[..., :2]), decoded[..., 2:] * SPEED * unit.px)
        return Motion(*(each[:, :CODED] for each in motion)), Motion(*(each[:, CODED:] for each in motion))

    def _codes(self, frames: Tensor) -> Tensor:
        """(B, CODED, K, code) of the seen `frames` (B, SEEN_FRAMES, 3, H, W), but for the first two."""
        small = functional.interpolate(frames.flatten(0, 1), (SIDE, SIDE), mode="area").unflatten(0, frames.shape[:2])
        pairs = torch.cat([small[:, :-1] - 0.5, small[:, 1:] - 0.5], dim=2).flatten(0, 1)
        line = torch.linspace(-1, 1, SIDE, device=frames.device)
        x, y = (each.expand(len(pairs), 1, -1, -1) for each in torch.meshgrid(line, line, indexing="xy"))
        parts = self.encode(torch.cat([pairs, x, y], dim=1)).unflatten(0, (len(frames), -1))
        parts = parts.unflatten(2, (self.objects, -1))
        return self.merge(torch.cat([parts[:, :-1], parts[:, 1:]], dim=-1))

    def _roll(self, first: Tensor, steps: int) -> Tensor:
        """(B, CODED + steps, K, code): the `first` ones and those foreseen."""
        codes = list(first.unbind(1))
        for _ in range(steps):
            foreseen = [core(codes[-offset]) for core, offset in zip(self.cores, OFFSETS, strict=True)]
            codes.append(self.aggregate(torch.cat(foreseen, dim=-1)).clamp(-LARGEST, LARGEST))
        return torch.stack(codes, dim=1)


def _encoder(inputs: int, widths: tuple[int, ...]) -> nn.Sequential:
    """Convolutions of those widths, each followed by a halving of the side: (B, inputs, SIDE, SIDE) to (B, last)."""
    layers: list[nn.Module] = []
    for before, after in zip((inputs, *widths), widths, strict=False):
        layers += [xavier(nn.Conv2d(before, after, 3, padding=1)), nn.ReLU(), nn.MaxPool2d(2)]
    return nn.Sequential(*layers, nn.Flatten())
