"""IFS, the Interaction Network from State: positions in, the next position out, over and over.

Watters et al. 2017 (arXiv 1706.01433), set up as in Ehrhardt et al. 2018, section 3.2: an object's state is the stack
of its last four positions, the first of them seen, the later ones forecast; one interaction core gives its next
position. It sees no film, so it knows the ground only as far as that is the same in every clip. Their supervised block
appends the velocity (`velocity`) and, on BowlS, the true axes of the ellipsoid; the axes are left out here, since
nothing else in the table is told them. Ours: the widths, and that what is learned is how far the next position lies
from the straight line through the last two, so that learning starts from uniform motion.
"""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen
from physpipe.predictors.interaction import InteractionCore
from physpipe.predictors.kinematics import CHANGE, FASTEST, SPEED, at
from physpipe.predictors.layers import FrameUnit


class IfsParams(Section):
    """Size of the network (ours) and what its state holds."""

    hidden: int = Field(ge=1)
    """Width of the core's layers."""
    velocity: bool
    """Whether the differences of the four positions are appended to them."""


class Ifs(Predictor):
    """Any number of objects; permuting them permutes the forecast. Asked times are whole frames after the last seen."""

    Params = IfsParams
    seen_frames = 4
    objects_alike = True

    def __init__(self, params: IfsParams, objects: int):
        super().__init__(params, objects)
        self.velocity = params.velocity
        inputs = 2 * self.seen_frames + 2 * (self.seen_frames - 1) * params.velocity
        self.core = InteractionCore(inputs, params.hidden, outputs=2)
        for weights in self.core.output[-1].parameters():
            nn.init.zeros_(weights)

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        unit = FrameUnit.of(seen.frames)
        ahead = (asked_times - seen.times[:, -1:]).long()  # (B, N) steps from the last seen frame
        return Forecast(unit.to_px(at(self._roll(unit.from_px(seen.xy), int(ahead.max())), ahead)))

    def _roll(self, places: Tensor, steps: int) -> Tensor:
        """(B, steps, K, 2) positions after the seen `places` (B, 4, K, 2)."""
        path = list(places.unbind(1))
        for _ in range(steps):
            path.append(self._next(torch.stack(path[-self.seen_frames :], dim=2)))
        return torch.stack(path[self.seen_frames :], dim=1)

    def _next(self, places: Tensor) -> Tensor:
        """(B, K, 2) the position after `places` (B, K, 4, 2)."""
        moves = places.diff(dim=2)
        state = places.flatten(2)
        if self.velocity:
            state = torch.cat([state, (moves / SPEED).flatten(2)], dim=2)
        move = moves[:, :, -1] + CHANGE * self.core(state).float()
        return places[:, :, -1] + move.clamp(-FASTEST, FASTEST)
