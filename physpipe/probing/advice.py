"""What a set of recordings should be ingested with."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from physpipe.ingest.dataset import clip_name
from physpipe.ingest.framing import CropParams
from physpipe.ingest.recording import SHORTEST
from physpipe.ingest.splits import SplitParams, drawn
from physpipe.io.clips import SPLITS, Split
from physpipe.probing.crop import clip_px, likely_crop
from physpipe.probing.findings import Finding

CLIP_FRAMES = (60, 48, 40, 32, 24, 20, 16, 14, 12, 11, 10, 9, 8)
"""Lengths of clips that are tried, the longest first."""
FEWEST_CLIPS = 10
"""Fewer clips are too few to learn, choose and test with."""
SAME_RATE = 0.1
"""Relative difference of frame rates that needs no resampling."""
UNEVEN = 0.02
"""Share of odd intervals beyond which a recording is resampled."""
ENOUGH_PX = 1.0
"""Clip pixels a frame: of film that moves less than half as fast, fewer frames will do."""
GAP_FRAMES = 5
"""Lost frames in a row that still leave a clip whole."""
FORECAST_FRAMES = 10
"""Frames that a forecast should reach at least, where clips are long enough."""


class Cut(NamedTuple):
    """How recordings are cut into clips."""

    frames: int
    """Of a clip."""
    clips: int
    """About how many of them there will be."""
    empty: tuple[Split, ...]
    """Splits that get none."""


@dataclass(frozen=True)
class Advice:
    """Values for the set's section of params.yaml; None leaves the choice to ingest."""

    fps: float | None
    source_fps: float | None
    crop: CropParams | None
    max_gap_s: float | None
    cut: Cut
    objects: int | None
    """None where recordings or frames do not agree."""
    radius_px: float | None
    """Of an object, in clip pixels."""

    def changes(self) -> dict[str, Any]:
        """Dotted key inside the section to its value, for what could be told."""
        known: dict[str, Any] = {
            "ingest.fps": self.fps,
            "ingest.source_fps": self.source_fps,
            "ingest.crop": None if self.crop is None else self.crop.model_dump(),
            "ingest.clip_frames": self.cut.frames,
            "ingest.min_frames": least_frames(self.cut.frames),
            "predict.horizon": horizon(self.cut.frames),
            "motion.objects": self.objects,
        }
        if self.max_gap_s is not None:
            known["ingest.max_gap_s"] = self.max_gap_s
        if self.radius_px is not None:
            known["evaluate.ball_radius_px"] = self.radius_px
        return known


def least_frames(clip_frames: int) -> int:
    """Frames that a recording's last clip has at least."""
    return max(SHORTEST, clip_frames // 2)


def horizon(clip_frames: int) -> int:
    """T, in frames: clips hold forecasts to 4 T, or, where they are short, at least to T."""
    return max((clip_frames - 1) // 4, min(FORECAST_FRAMES, clip_frames - 2))


def advise(found: Sequence[Finding], size: int, shares: SplitParams | None, source_fps: float | None) -> Advice:
    """The likeliest values for the recordings `found`.

    `size` is the side of the clips' frames in pixels; `shares` those of the splits, None where a split file decides;
    `source_fps` what the user says is true.
    """
    true_fps = source_fps or _tagged(found)
    rates = [true_fps or each.film.clock.measured_fps for each in found]
    crop = likely_crop(found)
    speeds = [each.speed_px * clip_px(each, crop, size) for each in found]
    fps = _rate(found, rates, speeds)
    slowest = fps or min(rates)
    lengths = {each.stem: _frames(each, rate, fps) for each, rate in zip(found, rates, strict=True)}
    radii = [each.diameter_px / 2 * clip_px(each, crop, size) for each in found if each.movers is not None]
    return Advice(
        fps=fps,
        source_fps=true_fps,
        crop=crop,
        max_gap_s=round(GAP_FRAMES / slowest, 2) if np.isfinite(slowest) else None,
        cut=_cut(lengths, shares),
        objects=_agreed(found),
        radius_px=round(median(radii), 1) if radii else None,
    )


def _tagged(found: Sequence[Finding]) -> float | None:
    """The rate that the camera wrote into every recording where it is not the one that they are stored at."""
    tags = {each.film.clock.tagged_fps for each in found}
    tag = tags.pop()
    stored = max(each.film.clock.measured_fps for each in found)
    return tag if not tags and tag > stored * (1 + SAME_RATE) else None


def _rate(found: Sequence[Finding], rates: Sequence[float], speeds: Sequence[float]) -> float | None:
    """Frames per second to resample to; None where the recordings' own rate will do."""
    if not np.isfinite(rates).all():
        return None
    slowest, speed = min(rates), max([each for each in speeds if np.isfinite(each)], default=np.inf)
    every = max(1, int(ENOUGH_PX / speed)) if speed < ENOUGH_PX / 2 else 1
    uneven = any(each.film.clock.uneven > UNEVEN for each in found)
    if every == 1 and not uneven and max(rates) < slowest * (1 + SAME_RATE):
        return None
    return round(slowest / every, 2)


def _frames(finding: Finding, rate: float, fps: float | None) -> int:
    """Frames from the first to the last that moves, of a recording of true `rate`, resampled to `fps`."""
    first, last = finding.span
    return int(finding.film.clock.frames * (last - first) * (1.0 if fps is None else fps / rate))


def _cut(lengths: dict[str, int], shares: SplitParams | None) -> Cut:
    """The longest clips of which there are some for each split, and enough; where not both can be, some for each."""
    options = []
    for frames in CLIP_FRAMES:
        names = [clip_name(stem, part) for stem, length in lengths.items() for part in range(_clips(length, frames))]
        filled = {drawn(name, shares) for name in names} if shares else set(SPLITS)
        options.append(Cut(frames, len(names), tuple(split for split in SPLITS if split not in filled)))
    return max(options, key=lambda cut: (-len(cut.empty), cut.clips >= FEWEST_CLIPS, cut.frames))


def _clips(length: int, clip_frames: int) -> int:
    return length // clip_frames + (length % clip_frames >= least_frames(clip_frames))


def _agreed(found: Sequence[Finding]) -> int | None:
    counts = {each.movers.number for each in found if each.movers is not None}
    return counts.pop() if len(counts) == 1 else None
