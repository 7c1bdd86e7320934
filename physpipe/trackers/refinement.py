"""From a point on an object to its centre: matching with its own mean look, made round (ours).

A heat map may settle on an edge or a highlight, always the same one: a constant offset (paper section 4.1). Round
objects have a centre that needs no label. The mean look of a clip's detections, averaged over all directions, is a
disc around the detection; where it fits best is the object's middle. Light from one side and a shadow are not round:
what is compared is the mix of colours that tells the object from its surroundings most surely (Fisher's linear
discriminant), in which shading counts as noise.
"""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.colour import srgb_to_lab
from physpipe.core.params import Section

Floats = NDArray[np.float32]


class RefineParams(Section):
    """How positions are moved to the middle of what they lie on."""

    rounds: int = Field(ge=1)
    """Times that the mean look is taken and fitted."""
    reach_px: int = Field(ge=4)
    """Half the side of the patch in which an object's size is sought."""
    search_px: int = Field(ge=1)
    """Farthest that a position moves along x and y."""
    extent: float = Field(ge=1)
    """Radius of what is compared, in radii of the object."""
    least_fit: float = Field(ge=-1, le=1)
    """Correlation below which a position stays where it was."""


def refined(frames: NDArray[np.uint8], xy: NDArray[np.floating], params: RefineParams) -> Floats:
    """(T, 2) middles of the object on which (T, 2) positions in (T, H, W, 3) frames lie; NaN stays NaN."""
    seen = np.flatnonzero(np.isfinite(xy).all(axis=1))
    middles = xy.astype(np.float32)
    if len(seen):
        middles[seen] = _centred(frames[seen], middles[seen], params)[0]
    return middles


class Look(NamedTuple):
    """How an object looks from any side."""

    mix: Floats
    """(3,) weights of L, a and b."""
    template: Floats
    """(P, P) that mix around the middle."""
    disc: Floats
    """(P, P) 1 where the two are compared, 0 in the corners."""

    def fit(self, patch: Floats, search_px: int) -> tuple[Floats, float]:
        """(2,) offset from the middle of a LAB `patch` at which it fits best, and how well; -1 at the rim."""
        return _fit(patch @ self.mix, self.template, self.disc, search_px)


class Searcher:
    """Finds an object again by the look that it had."""

    def __init__(self, frames: NDArray[np.uint8], xy: NDArray[np.floating], params: RefineParams):
        """From (N, H, W, 3) frames in which the object was at (N, 2)."""
        self.params = params
        self.look = _centred(frames, xy.astype(np.float32), params)[1]

    def near(self, frame: NDArray[np.uint8], xy: NDArray[np.floating], search_px: int) -> tuple[Floats, float] | None:
        """(2,) place in (H, W, 3), within `search_px` of (2,) along x and y, where it fits best, and how well.

        None where nothing fits.
        """
        corner, half = np.rint(xy).astype(int), len(self.look.template) // 2 + search_px
        offset, fit = self.look.fit(srgb_to_lab(_cut(frame[None], corner[None], half))[0], search_px)
        return (corner + offset, fit) if fit >= self.params.least_fit else None


def _centred(frames: NDArray[np.uint8], xy: Floats, params: RefineParams) -> tuple[Floats, Look]:
    """(N, 2) middles in (N, H, W, 3) frames, and the look that they were found by."""
    corners = np.rint(xy).astype(int)
    patches = srgb_to_lab(_cut(frames, corners, params.reach_px + params.search_px))
    start = (xy - corners).astype(np.float32)  # from each patch's middle
    offsets, look = start, None
    for _ in range(params.rounds):
        look = _mean_look(patches, offsets, params)
        fits = [look.fit(patch, params.search_px) for patch in patches]
        chosen = [new if fit >= params.least_fit else old for (new, fit), old in zip(fits, start, strict=True)]
        offsets = np.stack(chosen)
    assert look is not None  # there is at least one round
    return corners + offsets, look


def _cut(frames: NDArray[np.uint8], middle: NDArray[np.intp], half: int) -> NDArray[np.uint8]:
    """(N, 2 half + 1, 2 half + 1, 3) patches around whole pixels (N, 2), the frame's edge repeated outwards."""
    around = np.arange(-half, half + 1)
    rows = np.clip(middle[:, 1:] + around, 0, frames.shape[1] - 1)
    columns = np.clip(middle[:, :1] + around, 0, frames.shape[2] - 1)
    return frames[np.arange(len(frames))[:, None, None], rows[:, :, None], columns[:, None, :]]


def _mean_look(patches: Floats, offsets: Floats, params: RefineParams) -> Look:
    """Of the object at (N, 2) offsets from the middles of LAB `patches` (N, P, P, 3)."""
    looks = np.stack([_shifted(patch, offset, params.reach_px) for patch, offset in zip(patches, offsets, strict=True)])
    distance = _distances(params.reach_px)
    profile = _profile(np.median(looks, axis=0), distance)
    radius = _radius(profile)
    mix = _telling_colours(looks, distance, radius)
    half = int(np.clip(round(params.extent * radius) + 1, 3, params.reach_px))
    near = _distances(half)
    template = np.interp(near, np.arange(len(profile)), profile @ mix).astype(np.float32)
    return Look(mix, template, (near <= half + 0.5).astype(np.float32))


def _shifted(patch: Floats, offset: Floats, half: int) -> Floats:
    middle = (patch.shape[0] - 1) / 2
    size = (2 * half + 1, 2 * half + 1)
    return np.asarray(cv2.getRectSubPix(patch, size, (middle + float(offset[0]), middle + float(offset[1]))))


def _distances(half: int) -> NDArray[np.float64]:
    """(2 half + 1, 2 half + 1) pixels from the middle."""
    along = np.arange(-half, half + 1)
    return np.hypot(along, along[:, None])


def _profile(look: Floats, distance: NDArray[np.float64]) -> Floats:
    """(R, 3) mean colour at 0, 1, ... R - 1 pixels from the middle, each pixel shared by its two nearest."""
    inner = np.floor(distance).astype(int).ravel()
    part = distance.ravel() - inner
    count = len(distance) // 2 + 1
    weight = np.bincount(inner, 1 - part) + np.bincount(inner + 1, part)[:-1]
    sums = [np.bincount(inner, (1 - part) * c) + np.bincount(inner + 1, part * c)[:-1] for c in look.reshape(-1, 3).T]
    return (np.stack(sums, axis=1) / weight[:, None])[:count].astype(np.float32)


def _radius(profile: Floats) -> float:
    """Distance in pixels at which the colour is half-way from the object's to its surroundings'; pixels of both are
    within the profile."""
    contrast = np.linalg.norm(profile - profile[-3:].mean(axis=0), axis=1)
    half = float(contrast[:4].max()) / 2
    beyond = np.flatnonzero(contrast < half)
    radius = len(profile) / 2
    if len(beyond) and beyond[0] > 0:
        last, first = float(contrast[beyond[0] - 1]), float(contrast[beyond[0]])
        radius = float(beyond[0] - 1 + (last - half) / (last - first))
    return float(np.clip(radius, 1.5, len(profile) / 1.7))


def _telling_colours(looks: Floats, distance: NDArray[np.float64], radius: float) -> Floats:
    """(3,) unit vector: the mix of L, a and b that differs most from object to surroundings for its spread in both."""
    inside = looks[:, distance <= 0.85 * radius].reshape(-1, 3)
    outside = looks[:, (distance >= 1.3 * radius) & (distance <= 2.2 * radius)].reshape(-1, 3)
    apart = np.median(inside, axis=0) - np.median(outside, axis=0)
    spread = np.cov(inside.T) + np.cov(outside.T) + np.eye(3)  # one LAB unit: a flat colour has some noise, too
    mix = np.linalg.solve(spread, apart)
    return (mix / max(float(np.linalg.norm(mix)), 1e-9)).astype(np.float32)


def _fit(patch: Floats, template: Floats, disc: Floats, search: int) -> tuple[Floats, float]:
    """(2,) offset from the patch's middle at which the template fits best, to a part of a pixel, and how well."""
    middle, reach = patch.shape[0] // 2, template.shape[0] // 2 + search
    part = np.ascontiguousarray(patch[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1])
    fit = np.nan_to_num(cv2.matchTemplate(part, template, cv2.TM_CCOEFF_NORMED, mask=disc), nan=-1, posinf=-1)
    row, column = np.unravel_index(fit.argmax(), fit.shape)
    if not (0 < row < 2 * search and 0 < column < 2 * search):
        return np.zeros(2, np.float32), -1.0
    dx = _vertex(*fit[row, column - 1 : column + 2].tolist())
    dy = _vertex(*fit[row - 1 : row + 2, column].tolist())
    return np.array([column - search + dx, row - search + dy], np.float32), float(fit[row, column])


def _vertex(before: float, middle: float, after: float) -> float:
    """Where the parabola through three neighbours is highest, from the middle one."""
    bend = 2 * middle - before - after
    return (after - before) / (2 * bend) if bend > 0 else 0.0
