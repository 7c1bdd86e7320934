"""What the predictors share of motion: its scales, its beginning, its law. Lengths are in the unit of `FrameUnit`."""

import torch
from scipy.signal import savgol_coeffs
from torch import Tensor

SPEED = 1 / 16
"""A lively displacement a frame; brings inputs near 1."""
CHANGE = 1 / 128
"""A lively change of it a frame; brings outputs near 1."""
WEIGHT = 0.3
"""A lively weight of a seen position; the least-squares slope through four has 0.3 at its ends."""
FASTEST = 1.0
"""Largest displacement a frame along x and y: nothing that can be followed is as fast."""
FURTHEST = 1.0
"""Largest distance from the frame's centre along x and y: its edge."""
FEWEST = 5
"""Frames, odd, over which a cubic still smooths."""
POWERS = 6
"""Terms of a quadratic form in a displacement: 1, x, y, x^2, x y, y^2."""


def slope(places: Tensor, times: Tensor) -> Tensor:
    """(B, K, 2) slope of the least-squares line through `places` (B, T0, K, 2) at `times` (B, T0)."""
    centred = times - times.mean(1, keepdim=True)
    return torch.einsum("bt,btkd->bkd", centred / centred.square().sum(1, keepdim=True), places)


def past(places: Tensor) -> Tensor:
    """(B, K, 4 T0) what there is to read of seen `places` (B, T0, K, 2): from the last of them, and as they are."""
    from_last = (places - places[:, -1:]) / SPEED
    return torch.cat([each.transpose(1, 2).flatten(2) for each in (from_last, places)], dim=2)


def mended(mend: Tensor, places: Tensor, times: Tensor) -> tuple[Tensor, Tensor]:
    """Last position and displacement a frame, (B, K, 2) each, of `places` (B, T0, K, 2) seen at `times` (B, T0).

    They are the last place and the slope, moved by what was read of them: `mend` (B, K, 2 (T0 + 1)) holds, for each, a
    shift and weights of the earlier places.
    """
    T0 = places.shape[1]
    mend = mend.float().unflatten(2, (2, T0 + 1))
    earlier = (places[:, :-1] - places[:, -1:]).transpose(1, 2)  # (B, K, T0 - 1, 2)
    shift = CHANGE * mend[..., :2] + WEIGHT * mend[..., 2:] @ earlier  # (B, K, 2, 2): position, displacement
    return places[:, -1] + shift[:, :, 0], slope(places, times) + shift[:, :, 1]


def change(law: Tensor, displacement: Tensor) -> Tensor:
    """(..., 2) by which `displacement` (..., 2) changes in a frame.

    `law` (..., 2 POWERS) are coefficients of a quadratic form: on a terrain gravity's pull, friction, and what steers a
    path along a curved surface.
    """
    x, y = (displacement / SPEED).unbind(-1)
    powers = torch.stack([torch.ones_like(x), x, y, x * x, x * y, y * y], dim=-1)
    return CHANGE * (law.float().unflatten(-1, (2, POWERS)) @ powers.unsqueeze(-1)).squeeze(-1)


def smoothed(path: Tensor, frames: int) -> tuple[Tensor, Tensor, Tensor]:
    """(B, N, K, 2) places, the displacements that led there, and how those change in the next frame.

    Of `path` (B, T, K, 2) by the cubic nearest to `frames` of it around each (Savitzky and Golay 1964), where there are
    as many; N is T - frames + 1. Fewer frames, an odd number, are taken of a shorter path: two thirds of it at most.
    """
    longest = max(2 * path.shape[1] // 3, FEWEST)
    width = min(frames, longest - 1 + longest % 2, path.shape[1] - 1 + path.shape[1] % 2)
    around = path.unfold(1, width, 1)  # (B, N, K, 2, width)
    cubics = (path.new_tensor(savgol_coeffs(width, 3, deriv=order, use="dot")) for order in range(3))
    place, speed, turn = ((around * each).sum(-1) for each in cubics)  # a matrix product would round
    return place, speed - turn / 2, turn


def odd(frames: float) -> int:
    """The odd number of frames nearest to `frames`, and no fewer than a cubic is smoothed over."""
    return max(FEWEST, 2 * round((frames - 1) / 2) + 1)


def at(path: Tensor, ahead: Tensor) -> Tensor:
    """(B, N, ...) what `path` (B, steps, ...), frame after frame, holds `ahead` (B, N) frames from before it."""
    return path[torch.arange(len(path), device=path.device)[:, None], ahead - 1]
