"""The pictures that an overlay is drawn on: a clip's frames enlarged, or the film that it was cut from."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import video
from physpipe.io.clips import ClipSet
from physpipe.report.overlays import Marks

LONGEST_PX = 1280
"""Longest side of a film's pictures; larger film is reduced, so that marks stay visible and files small."""
ANY_FPS = 1.0
"""Times come from the clip; without a rate, images are refused."""
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class View:
    """A clip's pictures in the order of its frames, and where its pixels lie in them."""

    pictures: Iterator[Picture]
    place: Geometry
    """`to_source` turns clip pixels into pixels of the pictures."""

    def placed(self, marks: Marks) -> Marks:
        """Marks of the clip in pixels of the pictures."""
        spread = np.outer(1 / self.place.scale, 1 / self.place.scale)
        return Marks(
            truth=self.place.to_source(marks.truth),
            track=self.place.to_source(marks.track),
            forecast=self.place.to_source(marks.forecast),
            covariance=marks.covariance * spread,
        )


def of_clip(clips: ClipSet, clip: str, upscale: int) -> View:
    """The clip's own frames, `upscale` times larger."""
    width, height = (int(clips.rows(clip)[side].iloc[0]) for side in ("width", "height"))
    size = (width * upscale, height * upscale)
    enlarged = (_resized(frame, size, cv2.INTER_CUBIC) for frame in clips.frames(clip))
    return View(enlarged, Geometry(0, 0, *size, width, height))


def of_film(clips: ClipSet, clip: str, raw: Path) -> View:
    """The whole upright frames of the clip's recording in `raw`, reduced where they are larger than LONGEST_PX.

    Raises InputError when the film is not there, or is not that which the clip was cut from.
    """
    rows, geometry = clips.rows(clip), clips.geometry(clip)
    path = raw / str(rows["source"].iloc[0])
    if not path.exists():
        raise InputError(path, "no such film", "bring it back with `dvc checkout`, or draw on the clips: --pixels clip")
    first = next(_upright(path), None)
    if first is None:
        raise InputError(path, "holds no frame that can be decoded", "bring back the film that was ingested")
    height, width = first[1].shape[:2]
    factor = min(1.0, LONGEST_PX / max(height, width))
    size = (round(width * factor), round(height * factor))
    corner, crop = (factor * geometry.left, factor * geometry.top), (geometry.crop_width, geometry.crop_height)
    place = Geometry(*corner, factor * crop[0], factor * crop[1], geometry.width, geometry.height)
    return View(_shown(path, rows["source_frame"].tolist(), size), place)


def _shown(path: Path, numbers: list[int], size: tuple[int, int]) -> Iterator[Picture]:
    """The frames of those numbers, which do not fall; one that cannot be decoded shows the one before."""
    film = _upright(path)
    at, picture = next(film)
    for number in numbers:
        while at < number:
            following = next(film, None)
            if following is None:
                raise InputError(path, f"ends before frame {number}", "bring back the film that was ingested")
            at, picture = following
        yield _resized(picture, size, cv2.INTER_AREA)


def _upright(path: Path) -> Iterator[tuple[int, Picture]]:
    """Number and picture of every frame that can be decoded or comes after one that can."""
    picture = None
    for frame in video.Recording(path, ANY_FPS):
        if frame.image is not None:
            picture = video.rgb(frame.image)
        if picture is not None:
            yield frame.number, picture


def _resized(picture: Picture, size: tuple[int, int], interpolation: int) -> Picture:
    return cv2.resize(np.ascontiguousarray(picture), size, interpolation=interpolation).astype(np.uint8, copy=False)
