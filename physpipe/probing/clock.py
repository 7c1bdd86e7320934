"""What a recording's header and timestamps say, read from its packets without decoding them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from av.container import InputContainer
from numpy.typing import NDArray

from physpipe.core.errors import InputError
from physpipe.ingest import rates
from physpipe.io.video import Recording

MOST_BYTES = 400e6
"""Bytes read of one file: some minutes of film as phones store it."""
TRUE_RATE_TAGS = ("com.android.capture.fps",)
"""Where phones write the rate at which they filmed slow motion."""
FAST_FPS = 125.0
"""Few cameras film faster: such a rate may be a slip of the software that saved the file."""


class Packet(NamedTuple):
    """A frame as it is stored."""

    time_s: float
    """NaN where the file gives it none."""
    pts: int
    """The same in the stream's own unit."""
    is_key: bool
    """Whether it can be decoded without those before it."""


@dataclass(frozen=True)
class Clock:
    """How many frames, how fast."""

    frames: int
    length_s: float
    """NaN where the frames carry no times."""
    claimed_fps: float
    """What the header says."""
    measured_fps: float
    """What the timestamps say, or what the user says is true; NaN for images without it."""
    tagged_fps: float
    """What the camera wrote that it filmed at; NaN where it wrote nothing."""
    uneven: float
    """Share of the intervals between frames that are not as the others."""
    warnings: tuple[str, ...]


def of_images(count: int, source_fps: float | None) -> Clock:
    """The clock of `count` images, which have none of their own."""
    nan = float("nan")
    if source_fps is None:
        return Clock(count, nan, nan, nan, nan, 0.0, ("images carry no times: give their rate by --source-fps",))
    return Clock(count, count / source_fps, source_fps, source_fps, nan, 0.0, ())


def of_video(recording: Recording, tags: Mapping[str, str], packets: Sequence[Packet], complete: bool) -> Clock:
    """The clock of a video whose header `recording` has read; raises InputError where it carries no times.

    `tags` are what the camera wrote into the file; `complete` says whether the `packets` are all that there are.
    """
    if recording.source_fps is None:
        times_s = np.unique([each.time_s for each in packets])
    else:
        times_s = np.arange(len(packets)) / recording.source_fps
    if not np.isfinite(times_s).all():
        raise InputError(recording.path, "the frames carry no times", "give their true rate by --source-fps")
    promised_s = recording.promised_s
    if not complete:  # what was not read is not missing
        recording.promised_frames, recording.promised_s = 0, 0.0
    said = rates.summary(recording, times_s, np.ones(len(times_s), bool), fps=None)
    measured = said["measured_fps"]
    tagged = float(next(filter(None, map(tags.get, TRUE_RATE_TAGS)), "nan"))
    length_s = float(times_s[-1] - times_s[0]) + 1 / measured if len(times_s) > 1 else 0.0
    frames = len(times_s)
    warnings = [*said["warnings"], *_doubts(recording, measured, tagged)]
    if not complete:
        warnings.append(f"a long file: only its first {length_s:.0f} s were looked at")
        length_s, frames = promised_s or length_s, round(promised_s * measured) or frames
    return Clock(frames, length_s, recording.claimed_fps, measured, tagged, _uneven(times_s), tuple(warnings))


def _uneven(times_s: NDArray[np.float64]) -> float:
    intervals = np.diff(times_s)
    if not len(intervals):
        return 0.0
    usual = float(np.median(intervals))
    return float(np.mean(np.abs(intervals - usual) > rates.IRREGULAR * usual + rates.TICK_S))


def _doubts(recording: Recording, measured: float, tagged: float) -> list[str]:
    """Reasons to think that the timestamps are not those of the filming."""
    if recording.source_fps is not None:
        return []
    if tagged > measured * (1 + rates.WRONG_CLAIM):
        return [f"slow motion: filmed at {tagged:.4g} fps, stored at {measured:.4g}; give --source-fps {tagged:g}"]
    if measured > FAST_FPS:
        return [f"{measured:.4g} fps is a rate that few cameras reach; if the film runs too fast, give --source-fps"]
    return []


def read_packets(container: InputContainer) -> tuple[list[Packet], bool]:
    """The video's packets in the order of their times, and whether they are all: it stops after MOST_BYTES."""
    found, size = [], 0
    for packet in container.demux(container.streams.video[0]):
        size += packet.size
        if packet.size and not packet.is_discard:  # the last one is empty; an edit list hides some
            stamp = packet.dts if packet.pts is None else packet.pts
            time_s = float("nan") if stamp is None else float(stamp * packet.time_base)
            found.append(Packet(time_s, stamp or 0, packet.is_keyframe))
        if size > MOST_BYTES:
            return sorted(found), False
    return sorted(found), True
