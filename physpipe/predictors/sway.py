"""Where a hand-held camera sways to, told from how it moved between the seen frames (ours).

Positions are asked for in frames to come, and those move with the camera. A hand sways about a place that it holds: how
the last steps differ tells about where in its sway it is, and so where it goes.
"""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

FURTHEST = 128
"""Frames ahead, at most; nothing is told of those further off."""
UNSURE_PX = 0.01
"""Standard deviation of a seen step by noise, at least: a camera on a tripod tells nothing."""
FEWEST = 100
"""Stretches of film, along x or y, that as few weights are learned from."""


class Sway(nn.Module):
    """The camera's way from the last of T0 seen frames to a later one, linear in its way between those."""

    weights: Tensor

    def __init__(self, seen_frames: int):
        super().__init__()
        self.register_buffer("weights", torch.zeros(FURTHEST, seen_frames - 1))

    def forward(self, path: Tensor, ahead: Tensor) -> Tensor:
        """(B, N, 2) px to the frames `ahead` (B, N) of the last seen one; `path` (B, T0, 2) px is between those."""
        weights = self.weights[ahead.clamp(1, FURTHEST) - 1] * (ahead <= FURTHEST).unsqueeze(-1)  # (B, N, T0 - 1)
        return weights @ (path - path[:, -1:])[:, :-1]

    def fit(self, paths: Sequence[Tensor]) -> None:
        """Least squares over all stretches of the camera's `paths` (T, 2) px in film."""
        seen = self.weights.shape[1] + 1
        for ahead in range(1, FURTHEST + 1):
            cut = [
                path.double().unfold(0, seen + ahead, 1).flatten(0, 1) for path in paths if len(path) >= seen + ahead
            ]
            if sum(map(len, cut)) < FEWEST:
                break
            stretch = torch.cat(cut)  # (S, T0 + ahead)
            moved = stretch - stretch[:, seen - 1 : seen]
            before, after = moved[:, : seen - 1], moved[:, -1]
            square = before.T @ before + len(moved) * UNSURE_PX**2 * torch.eye(seen - 1, dtype=torch.float64)
            self.weights[ahead - 1] = torch.linalg.solve(square, before.T @ after)
