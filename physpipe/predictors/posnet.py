"""PosNet: regresses from the tensor state where each object is.

Ehrhardt et al. 2018, section 3.2. Ours: what is regressed is the steady change of displacement that leads to an object
from the motion that the state was last told. Without `follow`, as in the paper, that is what was seen last: the state
alone carries the motion, and nothing is added up. With it, that is what was regressed one frame before, and PosNet does
what DispNet does.
"""

from torch import Tensor

from physpipe.predictors.kinematics import FURTHEST
from physpipe.predictors.tensor_state import Motion, TensorState, TensorStateParams


class PosNet(TensorState):
    """Goes straight on before it has learned anything."""

    Params = TensorStateParams

    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        since = now.step + 1 - known.step
        place = known.place + since * known.displacement + since * (since + 1) / 2 * self._change(look, known)
        place = place.clamp(-FURTHEST, FURTHEST)  # far beyond its training the change leads out of the frame
        return Motion(place, place - now.place, now.step + 1)
