"""InterpNet: DispNet that also sees the last frame, and fills in what happens between.

Ehrhardt et al. 2018, section 4.4, and arXiv 1706.02179. Theirs: the first state is also made to tell the seen positions
and the one at the end. Ours: it asks its first layer, which is fine enough, where there is what it looks for; and every
step is told where the end so found lies, how soon it comes, and the steady change of displacement that leads there, of
which it adds to the law of motion as much as it trusts.
"""

from dataclasses import replace

import torch
from pydantic import Field
from torch import Tensor

from physpipe.predictors.base import Seen, Window, distance_px
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.kinematics import CHANGE, FURTHEST
from physpipe.predictors.layers import Locator, bilinear_weights, read_at, reader, zero_reader
from physpipe.predictors.scene import Scene
from physpipe.predictors.tensor_state import Motion, TensorStateParams

LIVELIEST = 16.0
"""Largest steady change, in lively ones: of an end that is missed at the last step, it is huge."""
DOUBT = 2.0
"""What the steady change is trusted less by before anything is learned, log odds."""


class InterpNetParams(TensorStateParams):
    """The state, and what it has to tell from the start."""

    first_state: float = Field(ge=0)
    """Weight of the mean distance of the positions that the first state tells."""


class InterpNet(DispNet):
    """Asked times end with the frame that is seen last."""

    Params = InterpNetParams
    sees_end = True
    look_extra = 5

    def __init__(self, params: InterpNetParams, objects: int):
        super().__init__(params, objects)
        self.first_state = params.first_state
        self.ask = reader(2 * params.channels + 2, params.hidden, outputs=(self.seen_frames + 1) * params.stem)
        self.locate = Locator(params.stem)
        self.trust = zero_reader(self.look_size, params.hidden, outputs=1)

    def _scene(self, seen: Seen) -> Scene:
        scene = super()._scene(seen)
        last = scene.places[:, -1]
        here = read_at(scene.state, bilinear_weights(last, scene.grid, scene.unit.aspect))
        asked = self.ask(torch.cat([here, scene.whole, last], dim=2)).unflatten(2, (self.seen_frames + 1, -1))
        found = self.locate(scene.detail, asked.transpose(1, 2).flatten(1, 2), scene.unit.aspect)
        return replace(scene, regressed=found.unflatten(1, (self.seen_frames + 1, -1)))

    def _look(self, scene: Scene, state: Tensor, weights: Tensor, known: Motion) -> Tensor:
        assert scene.regressed is not None
        way = scene.regressed[:, -1] - known.place
        left = scene.times[:, -1:] - scene.last_time - known.step  # (B, 1) frames from there to the end
        soon = 1 / left.clamp(min=1).unsqueeze(2).expand(-1, self.objects, -1)
        steady = 2 * (way * soon - known.displacement) * soon / (1 + soon)
        steady = (steady / CHANGE).clamp(-LIVELIEST, LIVELIEST)
        return torch.cat([steady, way, soon, super()._look(scene, state, weights, known)], dim=2)

    def _change(self, look: Tensor, known: Motion) -> Tensor:
        trust = torch.sigmoid(self.trust(look).float() - DOUBT)
        return super()._change(look, known) + CHANGE * trust * look[:, :, :2]

    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        moved = super()._move(look, known, now)
        return moved._replace(place=moved.place.clamp(-FURTHEST, FURTHEST))  # a long way off, the way would run away

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean distance from the target, and from the positions that the first state has to tell, in pixels."""
        scene = self._scene(batch.seen)
        assert scene.regressed is not None
        told = distance_px(scene.unit.to_px(scene.regressed), torch.cat([batch.seen.xy, batch.target[:, -1:]], 1))
        distance = distance_px(self._forecast_from(scene, batch.asked_times).mean, batch.target)
        parts = {"train_last_px": distance[:, -1].mean().item(), "train_end_px": told[:, -1].mean().item()}
        return distance.mean() + self.first_state * told.mean(), parts

    def validation_loss(self, batch: Window) -> Tensor:
        """The mean distance at all times in pixels, since the last of them is seen."""
        found = self(batch.seen, batch.asked_times).mean
        return torch.linalg.vector_norm(found - batch.target, dim=-1).mean()
