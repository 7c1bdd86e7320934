"""A few pairs of neighbouring frames from all over a recording.

The pipeline decodes every frame in order; a look at ten films must not take that long. So only short bursts behind key
frames are decoded, which is where a decoder may begin.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import av
import cv2
import numpy as np
from av.container import InputContainer
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.io import video
from physpipe.io.folders import images
from physpipe.probing import clock
from physpipe.probing.clock import Clock, Packet

PAIRS = 36
"""Pairs of neighbouring frames looked at, at most."""
BURSTS = 12
"""Places of a long recording that they come from, at most."""
LONGEST_PX = 480
"""Longest side of a picture looked at."""
MOST_PIXELS = 250e6
"""Pixels decoded of one recording: a second's work or two."""
FEWEST_FRAMES = 24
"""Frames decoded of one recording, however large."""
Picture = NDArray[np.uint8]


class Pair(NamedTuple):
    """Two neighbouring frames, (h, w, 3) RGB, upright and reduced."""

    place: float
    """Where in the recording, 0 to 1."""
    first: Picture
    second: Picture


@dataclass(frozen=True)
class Sample:
    """What was read of one recording."""

    clock: Clock
    width: int
    """Pixels of the upright frame."""
    height: int
    rotation: int
    """Degrees that the file asks to turn its pictures by; the pipeline and `pairs` heed it."""
    reduction: float
    """Source pixels per pixel of `pairs`."""
    pairs: tuple[Pair, ...]


Shown = tuple[float, av.VideoFrame, av.VideoFrame]
"""Place in the recording, a frame, the next one."""


def sample(path: Path, source_fps: float | None) -> Sample:
    """Looks into a video or a folder of images; raises InputError where it cannot be read."""
    if path.is_dir():
        files = images(path)
        return _sample(path, clock.of_images(len(files), source_fps), _pairs_of_images(files))
    recording = video.Recording(path, source_fps)
    first = next((frame.image for frame in islice(recording, FEWEST_FRAMES) if frame.image is not None), None)
    if first is None:
        raise InputError(path, "begins with no frame that can be decoded", "remove it or convert it anew")
    with av.open(path) as container:
        packets, complete = clock.read_packets(container)
        found = clock.of_video(recording, container.metadata, packets, complete)
    most = max(FEWEST_FRAMES, int(MOST_PIXELS / (first.width * first.height)))
    with av.open(path) as container:
        return _sample(path, found, _pairs_of_video(container, packets, most))


def _sample(path: Path, found: Clock, shown: Iterable[Shown]) -> Sample:
    pairs, shape, rotation = [], None, 0
    for place, *neighbours in shown:
        upright = [video.rgb(each) for each in neighbours]
        shape, rotation = shape or upright[0].shape, neighbours[0].rotation
        if {each.shape for each in upright} != {shape}:
            raise InputError(path, "its frames differ in size", "split the recording where its size changes")
        pairs.append(Pair(place, *map(_reduced, upright)))
    if shape is None:
        raise InputError(path, "has no two frames in a row that can be decoded", "film longer, or remove it")
    reduction = shape[1] / pairs[0].first.shape[1]
    return Sample(found, shape[1], shape[0], rotation, reduction, tuple(pairs))


def _reduced(picture: Picture) -> Picture:
    height, width = picture.shape[:2]
    factor = min(1.0, LONGEST_PX / max(height, width))
    size = (max(1, round(width * factor)), max(1, round(height * factor)))
    return cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)


def _pairs_of_images(files: Sequence[Path]) -> Iterator[Shown]:
    for at in _spread(len(files) - 1, PAIRS):
        first, second = (next(iter(video.Recording(file, 1.0))).image for file in files[at : at + 2])
        if first is not None and second is not None:
            yield at / len(files), first, second


def _pairs_of_video(container: InputContainer, packets: Sequence[Packet], most: int) -> Iterator[Shown]:
    stream = container.streams.video[0]
    bursts = _bursts(packets, most)
    for start, length in bursts:
        wanted = set(_spread(length - 1, max(1, PAIRS // len(bursts))))
        try:
            if start:
                container.seek(packets[start].pts, stream=stream)
            before: av.VideoFrame | None = None
            for number, frame in enumerate(islice(_from(container, packets[start].pts), length)):
                if before is not None and number - 1 in wanted:
                    yield (start + number - 1) / len(packets), before, frame
                before = frame
        except av.FFmpegError:  # damaged, or a file that cannot be wound: other bursts may still be read
            continue


def _from(container: InputContainer, pts: int) -> Iterator[av.VideoFrame]:
    """Frames that are shown at `pts` or later."""
    return (frame for frame in container.decode(video=0) if frame.pts is None or frame.pts >= pts)


def _bursts(packets: Sequence[Packet], most: int) -> list[tuple[int, int]]:
    """Number of the first frame and length of what is decoded, `most` frames in all."""
    if len(packets) <= most:
        return [(0, len(packets))]
    keys = [number for number, each in enumerate(packets[:-1]) if each.is_key] or [0]
    starts = [keys[at] for at in _spread(len(keys), min(BURSTS, most // 6))]
    ends = [*starts[1:], len(packets)]
    return [(start, min(most // len(starts), end - start)) for start, end in zip(starts, ends, strict=True)]


def _spread(count: int, most: int) -> list[int]:
    """Up to `most` of the numbers from 0 to `count` - 1, evenly spread."""
    return np.linspace(0, count - 1, min(count, most)).round().astype(int).tolist() if count > 0 else []
