"""DispNet: regresses from the tensor state how far each object moves in a frame, and adds the moves up.

Ehrhardt et al. 2018, section 3.2. Ours:

- what is read are the coefficients of a law of motion: the displacement changes by c + D d + Q(d, d), d being the
  displacement; on a terrain c is gravity's pull, D friction, Q what steers a path along a curved surface;
- the first displacement is a weighted sum of the seen positions, the weights being read from them too.
"""

from typing import ClassVar

import torch
from torch import Tensor

from physpipe.core.params import Section
from physpipe.predictors.layers import bilinear_weights, read_at, zero_reader
from physpipe.predictors.scene import SPEED, Scene
from physpipe.predictors.tensor_state import Motion, TensorState, TensorStateParams

CHANGE = 1 / 128
"""A lively change of a displacement a frame, in halves of the frame's longer side; brings outputs near 1."""
FASTEST = 1.0
"""Largest displacement a frame, in halves of the frame's longer side: nothing that can be followed is as fast."""
WEIGHT = 0.3
"""A lively weight of a seen position; the least-squares slope through four has 0.3 at its ends."""
POWERS = 6
"""Terms of a quadratic form in a displacement: 1, x, y, x^2, x y, y^2."""


class DispNet(TensorState):
    """Goes straight on before it has learned anything."""

    Params: ClassVar[type[Section]] = TensorStateParams

    def __init__(self, params: TensorStateParams, objects: int):
        super().__init__(params, objects)
        C, T0 = params.channels, self.seen_frames
        self.start = zero_reader(2 * C + 4 * T0, params.hidden, outputs=2 * (T0 + 1))
        self.change = zero_reader(self.look_size, params.hidden, outputs=2 * POWERS)

    def _begin(self, scene: Scene) -> Motion:
        """The tracks' own position and displacement, mended by what is seen."""
        places, last = scene.places, scene.places[:, -1]
        weights = bilinear_weights(last, scene.grid, scene.unit.aspect)
        past = ((places - last.unsqueeze(1)) / SPEED).transpose(1, 2).flatten(2)
        read = [read_at(scene.state, weights), scene.whole, past, places.transpose(1, 2).flatten(2)]
        mend = self.start(torch.cat(read, dim=2)).float().unflatten(2, (2, self.seen_frames + 1))
        earlier = (places[:, :-1] - last.unsqueeze(1)).transpose(1, 2)  # (B, K, T0 - 1, 2)
        mended = CHANGE * mend[..., :2] + WEIGHT * mend[..., 2:] @ earlier  # (B, K, 2, 2): position, displacement
        return Motion(last + mended[:, :, 0], scene.velocity() + mended[:, :, 1], step=0)

    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        law = self.change(look).float().unflatten(2, (2, POWERS))
        change = CHANGE * (law @ _powers(known.displacement / SPEED).unsqueeze(3)).squeeze(3)
        displacement = (now.displacement + change).clamp(-FASTEST, FASTEST)  # else the square term may run away
        return Motion(now.place + displacement, displacement, now.step + 1)


def _powers(displacement: Tensor) -> Tensor:
    """(..., POWERS) terms of a quadratic form in `displacement` (..., 2)."""
    x, y = displacement.unbind(-1)
    return torch.stack([torch.ones_like(x), x, y, x * x, x * y, y * y], dim=-1)
