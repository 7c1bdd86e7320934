"""Heat maps of a tracker's detectors, column by column, each shown once and under its name."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.report.embedding import webp

QUALITY = 85
Sheet = NDArray[np.uint8]


class Column(NamedTuple):
    """The same frames for every column: the film, or a detector's heat maps over it."""

    label: str
    picture: str


def heat_columns(sheets: Sequence[bytes], detectors: int) -> list[Column]:
    """The film, every start and each of the `detectors` in the end, of the PNGs of the first detector and of all.

    Both sheets begin with the film, and the last column of the first is the detector that comes next in the second.
    None where a sheet is missing.
    """
    if len(sheets) < 2:
        return []
    first, every = (_decoded(each) for each in sheets)
    width = every.shape[1] // (1 + detectors)
    starts = round(first.shape[1] / width) - 2
    ends = ["in the end"] if detectors == 1 else [f"object {number}, in the end" for number in range(detectors)]
    labels = ["film", *(f"start {number}" for number in range(starts))]
    cut = [*_cut(first, width)[: len(labels)], *_cut(every, width)[1:]]
    return [Column(label, webp(part, QUALITY)) for label, part in zip([*labels, *ends], cut, strict=True)]


def _decoded(png: bytes) -> Sheet:
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        raise OSError(f"heat maps of {len(png)} bytes cannot be decoded")
    return np.asarray(picture[:, :, ::-1], np.uint8)


def _cut(sheet: Sheet, width: int) -> list[Sheet]:
    return [sheet[:, left : left + width] for left in range(0, sheet.shape[1] - width + 1, width)]
