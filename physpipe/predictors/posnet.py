"""PosNet: regresses from the tensor state where each object is.

Ehrhardt et al. 2018, section 3.2. Ours: what is regressed is how far an object is from where going straight on would
have led it from the motion that the state was last told. Without `follow` that is what was seen last, so that the state
alone carries the motion and nothing is added up; with it, what was regressed one frame before.
"""

from torch import Tensor

from physpipe.predictors.dispnet import CHANGE
from physpipe.predictors.layers import zero_reader
from physpipe.predictors.scene import Scene
from physpipe.predictors.tensor_state import Motion, TensorState, TensorStateParams

FURTHEST = 2.0
"""Largest distance from the frame's centre along x and y, in halves of the frame's longer side; the edge is at 1."""


class PosNet(TensorState):
    """Goes straight on before it has learned anything."""

    Params = TensorStateParams

    def __init__(self, params: TensorStateParams, objects: int):
        super().__init__(params, objects)
        self.deviate = zero_reader(self.look_size, params.hidden, outputs=2)

    def _begin(self, scene: Scene) -> Motion:
        return Motion(scene.places[:, -1], scene.velocity(), step=0)

    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        since = now.step + 1 - known.step
        straight = known.place + since * known.displacement
        place = straight + CHANGE * since**2 * self.deviate(look).float()
        place = place.clamp(-FURTHEST, FURTHEST)  # else what it is told of may run away
        return Motion(place, place - now.place, now.step + 1)
