"""What moves in a recording: where, how large, how many, how fast; told from the background, not learned."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from physpipe.probing.scene import Mask, Picture, Scene

ALIKE = 1.6
"""Factor in diameter within which spots are of one size."""
NEARLY = 0.8
"""A larger size is preferred that shows in this share of the frames that the commonest shows in."""
EDGE = 0.4
"""Where something ends: at this part of how much it differs from the background."""
AGREED = 0.6
"""Share of the frames that must agree on how many objects there are."""


class Spot(NamedTuple):
    """A connected part of a frame that hides the background; pixels of the reduced picture."""

    x: float
    """Middle of the largest disc in it: of a ball, not of the rod that it hangs on."""
    y: float
    diameter: float
    """Of that disc."""
    inside: bool
    """Whether it ends within the frame: a hand reaches in from outside."""


class Movers(NamedTuple):
    """The objects of a recording, as far as a quick look tells; pixels of the reduced picture."""

    objects: list[list[Spot]]
    """In every first frame."""
    others: list[list[Spot]]
    """What else moves and is no smaller: hands, shadows, people."""
    diameter: float
    number: int | None
    """None where frames do not agree."""
    box: tuple[float, float, float, float]
    """Left, top, right, bottom of all that objects covered."""
    speeds: NDArray[np.float64]
    """Pixels a frame, of every object that was found again in the next frame."""


def movers(scene: Scene) -> Movers | None:
    """The likeliest objects; None where nothing moves."""
    if not scene.moving.any():
        return None
    seen = [_spots(*scene.covered(picture)) for picture in scene.first]
    usual = _usual_diameter(seen)
    if usual is None:
        return None
    objects = [[spot for spot in each if _is_object(spot, usual)] for each in seen]
    others = [[spot for spot in each if not _is_object(spot, usual)] for each in seen]
    x, y, diameter, _ = np.array([spot for each in objects for spot in each]).T
    left, top, right, bottom = x - diameter / 2, y - diameter / 2, x + diameter / 2, y + diameter / 2
    return Movers(
        objects=objects,
        others=[[spot for spot in each if spot.diameter > usual / ALIKE] for each in others],
        diameter=float(np.median(diameter)),
        number=_agreed([len(each) for each in objects if each]),
        box=(float(left.min()), float(top.min()), float(right.max()), float(bottom.max())),
        speeds=_speeds(scene, objects, usual),
    )


def _spots(mask: Mask, apart: Picture) -> list[Spot]:
    """The connected parts of `mask`, where the picture is `apart` grey levels from the background."""
    height, width = mask.shape
    number, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    found = []
    for label in range(1, number):
        left, top, w, h, _ = map(int, stats[label])
        part = np.s_[top : top + h, left : left + w]
        own = np.where(labels[part] == label, apart[part], 0)
        x, y, diameter = _largest_disc(own > EDGE * np.quantile(own[own > 0], 0.9))
        inside = left > 1 and top > 1 and left + w < width - 1 and top + h < height - 1
        found.append(Spot(left + x, top + y, diameter, inside))
    return found


def _largest_disc(shape: Mask) -> tuple[float, float, float]:
    """x, y and diameter in pixels of the largest disc in `shape`, its holes filled."""
    whole = ndimage.binary_fill_holes(np.pad(shape, 1))
    depth = cv2.distanceTransform(whole.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    y, x = (float(each.mean()) for each in np.nonzero(depth >= depth.max() - 0.5))
    return x - 1, y - 1, 2 * float(depth.max()) - 1


def _is_object(spot: Spot, usual: float) -> bool:
    return spot.inside and max(spot.diameter, usual) <= ALIKE * min(spot.diameter, usual)


def _usual_diameter(seen: Sequence[Sequence[Spot]]) -> float | None:
    """The size that most frames show a spot of; of sizes that show about as often, the largest."""
    diameters = np.array([spot.diameter for each in seen for spot in each if spot.inside])
    if not len(diameters):
        return None
    sizes = np.geomspace(diameters.min(), diameters.max(), 40)
    shown = np.array([sum(any(_is_object(spot, size) for spot in each) for each in seen) for size in sizes])
    best = sizes[shown >= NEARLY * shown.max()].max()
    return float(np.median(diameters[(diameters <= ALIKE * best) & (diameters >= best / ALIKE)]))


def _agreed(numbers: Sequence[int]) -> int | None:
    number, times = Counter(numbers).most_common(1)[0]
    return number if times >= AGREED * len(numbers) else None


def _speeds(scene: Scene, objects: Sequence[Sequence[Spot]], usual: float) -> NDArray[np.float64]:
    """How far objects are from where they were a frame before; where their number changes, nothing is said."""
    found = []
    for before, picture in zip(objects, scene.second, strict=True):
        after = [spot for spot in _spots(*scene.covered(picture)) if _is_object(spot, usual)] if before else []
        if len(after) == len(before):
            found += [min(float(np.hypot(each.x - spot.x, each.y - spot.y)) for each in after) for spot in before]
    return np.array(found)
