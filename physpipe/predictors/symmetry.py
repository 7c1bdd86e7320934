"""Mean forecast over the frame's mirrors and turns: physics seen in a mirror is physics (ours)."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import torch
from torch import Tensor

from physpipe.predictors.base import Seen


def mean_over_symmetries(forecast: Callable[[Seen, Tensor], Tensor], seen: Seen, asked_times: Tensor) -> Tensor:
    """(B, N, K, 2) pixels: the mean of `forecast` over the eight symmetries of a square frame, four of any other.

    Mirroring the scene thus mirrors the forecast exactly.
    """
    height, width = seen.frames.shape[-2:]
    swaps = (False, True) if height == width else (False,)
    found = []
    for flip_x, flip_y, swap in product((False, True), (False, True), swaps):
        frames = seen.frames.flip([axis for axis, flip in ((-1, flip_x), (-2, flip_y)) if flip])
        xy = mirrored(seen.xy, flip_x, flip_y, height, width)
        if swap:
            frames, xy = frames.transpose(-1, -2), xy.flip(-1)
        asked = forecast(replace(seen, frames=frames, xy=xy), asked_times)
        found.append(mirrored(asked.flip(-1) if swap else asked, flip_x, flip_y, height, width))
    return torch.stack(found).mean(0)


def mirrored(xy: Tensor, flip_x: bool, flip_y: bool, height: int, width: int) -> Tensor:
    """(..., 2) pixels in a frame mirrored in x, in y."""
    x, y = xy.unbind(-1)
    return torch.stack([width - 1 - x if flip_x else x, height - 1 - y if flip_y else y], dim=-1)
