"""The part of a recording's frame that becomes the clip's, and its size."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.core.params import Section


class CropParams(Section):
    """The part of the upright frame to keep, in source pixels."""

    left: int = Field(ge=0)
    """Pixels left of the box."""
    top: int = Field(ge=0)
    """Pixels above the box."""
    width: int = Field(ge=1)
    """Pixels."""
    height: int = Field(ge=1)
    """Pixels."""


def geometry(path: Path, shape: tuple[int, ...], crop: CropParams | None, size: int) -> Geometry:
    """The crop box (None: the largest centred square) of frames of `shape` (height, width, ...), made `size` px wide.

    Raises InputError, naming the recording at `path`, for a box that leaves the frame.
    """
    height, width = shape[:2]
    side = min(height, width)
    box = crop or CropParams(left=(width - side) // 2, top=(height - side) // 2, width=side, height=side)
    right, bottom = box.left + box.width, box.top + box.height
    if right > width or bottom > height:
        reason = f"the crop box ends at ({right}, {bottom}), outside the frame of {width} x {height} px"
        raise InputError(path, reason, "correct `crop` of this data set in params.yaml")
    return Geometry(box.left, box.top, box.width, box.height, size, size)


def reframed(pixels: NDArray[np.uint8], geometry: Geometry) -> NDArray[np.uint8]:
    """(H, W, 3) source pixels, cropped and resized; every source pixel counts by its area."""
    left, top = int(geometry.left), int(geometry.top)
    box = pixels[top : top + int(geometry.crop_height), left : left + int(geometry.crop_width)]
    return cv2.resize(box, (geometry.width, geometry.height), interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)
