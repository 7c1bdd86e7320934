"""How an object looks from any side, and where that fits in a picture."""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

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
    object_part: float = Field(gt=0, le=1)
    """Colours within this many radii are the object's."""
    ground_part: tuple[float, float]
    """Colours between so many and so many radii are its surroundings'."""
    least_radius_px: float = Field(gt=0)
    """No object is taken for smaller."""

    @model_validator(mode="after")
    def _the_ground_lies_outside(self) -> "RefineParams":
        if not self.object_part < self.ground_part[0] < self.ground_part[1]:
            raise ValueError(f"surroundings at {list(self.ground_part)} radii, the object up to {self.object_part}")
        return self


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


def mean_look(patches: Floats, offsets: Floats, params: RefineParams) -> Look:
    """Of the object at (N, 2) offsets from the middles of LAB `patches` (N, P, P, 3)."""
    looks = np.stack([_shifted(patch, offset, params.reach_px) for patch, offset in zip(patches, offsets, strict=True)])
    distance = _distances(params.reach_px)
    profile = _profile(np.median(looks, axis=0), distance)
    radius = _radius(profile, params.least_radius_px)
    mix = _telling_colours(looks, distance / radius, params)
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


def _radius(profile: Floats, least_px: float) -> float:
    """Distance in pixels at which the colour is half-way from the object's to its surroundings'; pixels of both are
    within the profile."""
    contrast = np.linalg.norm(profile - profile[-3:].mean(axis=0), axis=1)
    half = float(contrast[:4].max()) / 2
    beyond = np.flatnonzero(contrast < half)
    radius = len(profile) / 2
    if len(beyond) and beyond[0] > 0:
        last, first = float(contrast[beyond[0] - 1]), float(contrast[beyond[0]])
        radius = float(beyond[0] - 1 + (last - half) / (last - first))
    return float(np.clip(radius, least_px, len(profile) / 1.7))


def _telling_colours(looks: Floats, radii: NDArray[np.float64], params: RefineParams) -> Floats:
    """(3,) unit vector: the mix of L, a and b that differs most from object to surroundings for its spread in both.

    `radii` (P, P): distance of each pixel from the middle, in radii of the object.
    """
    least, most = params.ground_part
    inside = looks[:, radii <= params.object_part].reshape(-1, 3)
    outside = looks[:, (radii >= least) & (radii <= most)].reshape(-1, 3)
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
