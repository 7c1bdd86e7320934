"""DispNet: regresses from the tensor state how far each object moves in a frame, and adds the moves up.

Ehrhardt et al. 2018, section 3.2. Ours: a move is the one before, changed by the law of motion that the state tells.
"""

from typing import ClassVar

from torch import Tensor

from physpipe.core.params import Section
from physpipe.predictors.kinematics import FASTEST
from physpipe.predictors.tensor_state import Motion, TensorState, TensorStateParams


class DispNet(TensorState):
    """Goes straight on before it has learned anything."""

    Params: ClassVar[type[Section]] = TensorStateParams

    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        displacement = now.displacement + self._change(look, known)
        displacement = displacement.clamp(-FASTEST, FASTEST)  # else the law's square term may run away
        return Motion(now.place + displacement, displacement, now.step + 1)
