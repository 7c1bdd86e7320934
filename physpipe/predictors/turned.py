"""A path that a straight wall has turned, seen as if it had come straight to where it goes since (ours).

What came before the touch is mirrored in the wall and shrunk by the restitution (the method of images), which makes the
whole path straight. So a velocity can be read of frames on both sides of a touch, which a line through them misses.
"""

from typing import NamedTuple

import torch
from torch import Tensor

SURE = 0.2
"""Noise of a track over that of a wall's place: the camera sways, and an object's size is known no better."""
EARLY = 0.2
"""Frames by which noise may move a touch out of its frame."""
FOUND = (3 / 192) ** 2
"""By how much the squared distances must be less for a touch to be seen: three times a noise of 1/3 pixel of 128."""


class Turned(NamedTuple):
    """A path after the last touch that is seen in it."""

    places: Tensor
    """(B, T, K, 2)."""
    push: Tensor
    """(B, K, 2) change of the displacement by the touch, 0 where there was none."""
    touched: Tensor
    """(B, K, 2) whether there was one, along x and along y."""


class _Fits(NamedTuple):
    """Paths with a touch after each of the first T - 1 frames, fitted to each axis and side: (B, K, 2, 2, T - 1)."""

    side: Tensor
    speed: Tensor
    """Away from the side, a frame."""
    off: Tensor
    """Squared distances; infinite where it would touch in another frame, or go on through the side."""


def unfolded(places: Tensor, sides: Tensor, restitution: Tensor, powers: int = 1) -> Turned:
    """Of `places` (B, T, K, 2) in successive frames between `sides` (B, K, 2, 2): how far from the middle left and up,
    then right and down.

    A touch is seen where Newton's law of impact explains a path better than a polynomial in time of `powers` does, with
    a side near where it is thought to be.
    """
    signs = places.new_tensor([-1.0, 1.0])[:, None]
    out = signs * places.unsqueeze(-2)  # (B, T, K, 2, 2)
    before = _before(places.shape[1], places)
    fits = _fitted(out, sides, before, restitution)
    least, best = fits.off.transpose(2, 3).flatten(3).min(-1, keepdim=True)  # of both sides and all moments
    touched = least.squeeze(-1) + FOUND < _unsteady(places, powers)
    side = fits.side.unsqueeze(1)
    mirrored = torch.where(before, side + restitution * (side - out.unsqueeze(-1)), out.unsqueeze(-1))
    paths = (signs.unsqueeze(-1) * mirrored).transpose(3, 4).flatten(4)
    speeds = (-signs.unsqueeze(-1) * fits.speed).transpose(2, 3).flatten(3)
    path = paths.gather(-1, best.unsqueeze(1).expand(*places.shape, 1)).squeeze(-1)
    push = (1 + 1 / restitution) * speeds.gather(-1, best).squeeze(-1)
    return Turned(torch.where(touched.unsqueeze(1), path, places), touched * push, touched)


def _before(frames: int, like: Tensor) -> Tensor:
    """(T, 1, 1, 1, T - 1) whether a frame is before a touch that follows the first, the second, ..."""
    time = torch.arange(frames, device=like.device)
    return (time[:, None] <= time[:-1])[:, None, None, None]


def _fitted(out: Tensor, sides: Tensor, before: Tensor, restitution: Tensor) -> _Fits:
    """Least squares, `sides` being known as well as SURE tells; `out` (B, T, K, 2, 2) is how far out each place is."""
    design = _design(before[:, 0, 0, 0], restitution)
    told = torch.cat([out, SURE * sides.unsqueeze(1)], dim=1)
    fit = torch.einsum("hpt,btkse->bkseph", torch.linalg.pinv(design), told)
    off = (torch.einsum("htp,bkseph->btkseh", design, fit) - told.unsqueeze(-1)).square().sum(1)
    side, speed, mark = fit.unbind(-2)
    touch = mark / speed.where(speed > 0, 1) - torch.arange(before.shape[-1], device=out.device)
    likely = (speed > 0) & (touch > -EARLY) & (touch < 1 + EARLY)
    return _Fits(side, speed, off.where(likely, torch.inf))


def _design(before: Tensor, restitution: Tensor) -> Tensor:
    """(T - 1, T + 1, 3): what the side's place, the speed away from it, and that times the moment of the touch
    contribute to every place; in the last row to the side's known place."""
    time = torch.arange(len(before), device=before.device).to(restitution).unsqueeze(1)
    share = torch.where(before, -1 / restitution, torch.ones_like(restitution))
    rows = torch.stack([torch.ones_like(share), -share * time, share], dim=-1)
    known = restitution.new_tensor([SURE, 0.0, 0.0]).expand(1, before.shape[1], 3)
    return torch.cat([rows, known]).transpose(0, 1)


def _unsteady(places: Tensor, powers: int) -> Tensor:
    """(B, K, 2) squared distances of `places` (B, T, K, 2) from the nearest polynomial in time along each axis."""
    time = torch.arange(places.shape[1], device=places.device).to(places)
    terms = torch.stack([time**power for power in range(powers + 1)], dim=1)
    return (places - torch.einsum("ut,btkd->bukd", terms @ torch.linalg.pinv(terms), places)).square().sum(1)
