"""A training batch, and what of it may not be looked at."""

from dataclasses import dataclass

import torch
from torch import Tensor

from physpipe.tracknet.losses import even_motion_target, motion_target


@dataclass(frozen=True)
class Moments:
    """A training batch."""

    frames: Tensor
    """(B, 5, 3, H, W) in [0, 1], five moments of one film in their natural order."""
    background: Tensor
    """(B, 3, H, W) temporal median of each film."""
    ignored: Tensor | None = None
    """(B, 5, h, w) heat-map cells where nothing may be found (sequential masking), or None."""

    def motion(self, stride: int) -> Tensor:
        """(B * 5, h, w) share of each frame's motion residual in each cell, ignored ones included."""
        return motion_target(*self._frames_and_backgrounds(), stride)

    def even_motion(self, stride: int, even: float, nearby_cells: int) -> Tensor:
        """As `motion`, evened out as by `even_motion_target`."""
        return even_motion_target(*self._frames_and_backgrounds(), stride, even, nearby_cells)

    def _frames_and_backgrounds(self) -> tuple[Tensor, Tensor]:
        return self.frames.flatten(0, 1), self.background.repeat_interleave(self.frames.shape[1], 0)

    def outside_mask(self, cells: Tensor) -> Tensor:
        """(B * 5, h, w) `cells`, 0 where ignored."""
        return cells if self.ignored is None else cells * ~self.ignored.flatten(0, 1)


def masked(logits: Tensor, ignored: Tensor | None) -> Tensor:
    """Scores shifted to be positive, then zero where `ignored`, as the paper does before the softmax (section 3.1).

    A softmax gives exp(0 - bias) at those cells: with a bias of 100 above the lowest score, nothing.
    """
    if ignored is None:
        return logits
    lowest = logits.flatten(1).min(1).values[:, None, None]
    return torch.where(ignored.view(logits.shape), torch.zeros_like(logits), logits - lowest + 100.0)
