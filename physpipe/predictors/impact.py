"""What running into something does to an object within a frame (ours)."""

from typing import NamedTuple, Self

import torch
from torch import Tensor

SOFT = 1 / 128
"""Distance over which a touch would be ever more certain, for gradients alone: half a pixel of 128."""


class Impact(NamedTuple):
    """What an object's motion changes by."""

    push: Tensor
    """(B, M, K, 2) change of the displacement."""
    moved: Tensor
    """(B, M, K, 2) by how much more it is displaced in this frame: what is left of it after the touch."""
    slid: Tensor
    """(B, M, K, 2) how much more it slides."""

    @classmethod
    def none(cls, displacement: Tensor) -> Self:
        """Of running into nothing."""
        return cls(*(torch.zeros_like(displacement) for _ in cls._fields))

    def and_of(self, other: Self) -> Self:
        """Of both in one frame."""
        return type(self)(*(one + another for one, another in zip(self, other, strict=True)))


def certain(within: Tensor) -> Tensor:
    """1 where positive, else 0; with the gradient of a soft step, which distances of touches are learned by."""
    soft = torch.sigmoid(within / SOFT)
    return soft + ((within > 0).to(soft) - soft).detach()
