"""Recordings as filmed: video files and folders of images, decoded from the first frame to the last, never seeking."""

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import av
import numpy as np
from av.container import InputContainer
from av.video.stream import VideoStream
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.io.folders import images

LONGEST_GAP_S = 3600.0  # a timestamp that jumps further is broken


@dataclass(frozen=True)
class SourceFrame:
    """One frame of a recording; `image` is None when it could not be decoded."""

    number: int
    """Place in decode order, from 0; a frame that cannot be decoded keeps its number."""
    time_s: float
    image: av.VideoFrame | None


class Recording:
    """One recording; iterate it once to get its frames in the order of their times.

    Times are the stream's own timestamps, or frame number / `source_fps` where that is given.
    """

    def __init__(self, path: Path, source_fps: float | None):
        """Raises InputError for a folder of images without `source_fps`."""
        if path.is_dir() and source_fps is None:
            raise InputError(path, "images carry no times", "set `source_fps` of this data set in params.yaml")
        self.path = path
        self.source_fps = source_fps
        self.claimed_fps = math.nan
        """What the header says; may lie."""
        self.promised_frames = 0
        """How many frames the header promises; 0 where it does not say."""
        self.promised_s = 0.0
        """How long the header says the recording is; 0 where it does not say."""
        self.repaired_times = 0
        """Timestamps that were absent, did not grow or jumped far, and were set one interval after the one before."""
        self.pixel_aspect = 1.0
        """Width over height of one pixel."""

    def __iter__(self) -> Iterator[SourceFrame]:
        """Raises InputError when the recording cannot be read at all."""
        raw = self._from_images() if self.path.is_dir() else self._from_video()
        time_s, interval_s = -math.inf, math.nan
        for number, (stamp, image) in enumerate(raw):
            if self.source_fps is not None:
                yield SourceFrame(number, number / self.source_fps, image)
                continue
            if stamp is None or stamp <= time_s or stamp > time_s + LONGEST_GAP_S > -math.inf:
                stamp = self._repair(time_s, interval_s)
            time_s, interval_s = stamp, stamp - time_s
            yield SourceFrame(number, time_s, image)

    def _repair(self, before_s: float, interval_s: float) -> float:
        self.repaired_times += 1
        interval_s = interval_s if math.isfinite(interval_s) else 1 / self.claimed_fps
        if not (math.isfinite(before_s) and math.isfinite(interval_s)):
            raise InputError(self.path, "the frames carry no times", "set `source_fps` of this data set")
        return before_s + interval_s

    def _from_images(self) -> Iterator[tuple[None, av.VideoFrame | None]]:
        for path in images(self.path):
            try:
                with av.open(path) as container:
                    yield None, next(container.decode(video=0), None)
            except (av.FFmpegError, IndexError):
                yield None, None

    def _from_video(self) -> Iterator[tuple[float | None, av.VideoFrame | None]]:
        if self.path.stat().st_size == 0:
            raise InputError(self.path, "the file is empty (0 bytes)", "copy it again or remove it")
        try:
            container = av.open(self.path)
        except av.FFmpegError as error:
            reason = f"not a readable video ({error.strerror})"
            raise InputError(self.path, reason, "remove it, or convert it with `ffmpeg -i IN OUT.mp4`") from None
        with container:
            if not container.streams.video:
                raise InputError(self.path, "holds no video stream", "remove it")
            stream = container.streams.video[0]
            self._read_header(container, stream)
            yield from _decoded(container, stream)

    def _read_header(self, container: InputContainer, stream: VideoStream) -> None:
        self.claimed_fps = float(stream.average_rate or stream.guessed_rate or math.nan)
        self.promised_frames = stream.frames
        self.pixel_aspect = float(stream.sample_aspect_ratio or 1)
        self.promised_s = (container.duration or 0) / av.time_base


def _decoded(container: InputContainer, stream: VideoStream) -> Iterator[tuple[float | None, av.VideoFrame | None]]:
    """Time and image of every frame; a packet that fails gives (time, None) in its place."""
    stream.codec_context.thread_count = 1  # recordings run in parallel; threads blur which packet failed
    failed: list[float] = []
    for packet in _packets(container, stream):
        try:
            frames = packet.decode()
        except av.FFmpegError:
            if packet.pts is None:
                yield None, None
            else:
                heapq.heappush(failed, float(packet.pts * packet.time_base))
            continue
        for frame in frames:
            while failed and frame.time is not None and failed[0] < frame.time:
                yield heapq.heappop(failed), None
            yield frame.time, None if frame.is_corrupt else frame
    yield from ((time_s, None) for time_s in sorted(failed))


def _packets(container: InputContainer, stream: VideoStream) -> Iterator[av.Packet]:
    try:
        yield from container.demux(stream)
    except av.FFmpegError:  # cut in the middle: what came before still counts
        return


def rgb(image: av.VideoFrame) -> NDArray[np.uint8]:
    """(H, W, 3) upright RGB of any pixel format; transparent parts become black."""
    if any(component.is_alpha for component in image.format.components):
        rgba = image.to_ndarray(format="rgba")
        pixels = (rgba[..., :3] * (rgba[..., 3:] / 255.0)).round().astype(np.uint8)
    else:
        pixels = image.to_ndarray(format="rgb24").astype(np.uint8, copy=False)
    return np.rot90(pixels, round(image.rotation / 90)) if image.rotation else pixels
