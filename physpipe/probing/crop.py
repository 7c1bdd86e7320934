"""The part of the frame that clips should show."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from physpipe.core.geometry import Geometry
from physpipe.ingest import framing
from physpipe.ingest.framing import CropParams
from physpipe.probing.findings import Finding

MARGIN = 1.0
"""Diameters left free around all that was seen: a look misses the farthest moments."""
WORTH_IT = 0.85
"""A crop is worth its while when its side is shorter than this part of the largest centred square's."""


def geometry(finding: Finding, crop: CropParams | None, size: int) -> Geometry:
    """Where clips of `size` pixels lie in the frame of a recording."""
    return framing.geometry(Path(finding.source), (finding.film.height, finding.film.width), crop, size)


def likely_crop(found: Sequence[Finding]) -> CropParams | None:
    """The square around all that objects covered; None, the largest centred square, where it would gain little."""
    boxes = [each.box for each in found if each.box is not None]
    sizes = {(each.film.width, each.film.height) for each in found}
    if not boxes or len(sizes) > 1:  # one box cannot fit frames of several sizes
        return None
    width, height = sizes.pop()
    (left, top), (right, bottom) = np.min(boxes, axis=0)[:2].tolist(), np.max(boxes, axis=0)[2:].tolist()
    margin = MARGIN * max(each.diameter_px for each in found if each.box is not None)
    side = min(max(right - left, bottom - top) + 2 * round(margin), width, height)
    corner = [_placed((left + right - side) // 2, width - side), _placed((top + bottom - side) // 2, height - side)]
    centred = [(most - side) // 2 for most in (width, height)]
    if side > WORTH_IT * min(width, height) and np.abs(np.subtract(corner, centred)).max() < (1 - WORTH_IT) * side:
        return None
    return CropParams(left=corner[0], top=corner[1], width=side, height=side)


def _placed(start: int, last: int) -> int:
    return min(max(start, 0), last)


def clip_px(finding: Finding, crop: CropParams | None, size: int) -> float:
    """Clip pixels per pixel of the recording."""
    return float(geometry(finding, crop, size).scale[0])
