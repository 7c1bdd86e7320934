"""Forecasts of whole clips from their first frames."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import torch
from numpy.typing import NDArray

from physpipe.core.determinism import device
from physpipe.core.errors import InputError
from physpipe.core.progress import progress
from physpipe.io import forecasts, tracks
from physpipe.io.clips import TABLE, ClipSet, Split
from physpipe.predictor_learning.arrays import as_input
from physpipe.predictor_learning.windows import KEYS
from physpipe.predictors.base import Forecast, Predictor, Seen

TOGETHER = 32
"""Clips in one batch; changes no forecast."""
HORIZONS = 4
"""Forecasts reach this many times T."""


@dataclass(frozen=True)
class Forecasts:
    """A table of `physpipe.io.forecasts`, and how many clips have none because an object is lost at their start."""

    table: pd.DataFrame
    skipped: int


def forecast(
    predictor: Predictor,
    clips: ClipSet,
    table: pd.DataFrame,
    split: Split,
    horizon: int,
    what: str,
    end: int | None = None,
) -> Forecasts:
    """Forecasts of frames T0 to 4 T (T = `horizon`) or to each clip's end, from its frames 0 to T0 - 1.

    A predictor that sees the end is shown frame `end` too and forecasts up to it; clips without it are left out.
    Raises InputError when no clip of the split reaches frame T (or `end`), or its tracks lack a clip.
    """
    needed, last = horizon, HORIZONS * horizon
    if predictor.sees_end:
        assert end is not None
        needed = last = end
    names = clips.names(split)
    lengths = {name: len(clips.rows(name)) for name in names}
    if max(lengths.values(), default=0) <= needed:
        reason = f"no {split} clip reaches frame {needed}"
        raise InputError(clips.folder / TABLE, reason, f"lower {KEYS} or give longer clips")
    starts = _starts(clips, table, names, predictor.seen_frames)
    usable = [name for name in names if name in starts and (lengths[name] > needed or not predictor.sees_end)]
    parts = [forecasts.empty()]
    for first in progress(range(0, len(usable), TOGETHER), what):
        together = usable[first : first + TOGETHER]
        found = _forecast_batch(predictor, clips, together, starts, last)
        for i, name in enumerate(together):
            stop = min(last + 1, lengths[name])
            parts.append(_rows(name, predictor.seen_frames, stop, found, i))
    return Forecasts(pd.concat(parts, ignore_index=True), len(names) - len(usable))


def _starts(clips: ClipSet, table: pd.DataFrame, names: list[str], seen_frames: int) -> dict[str, NDArray[np.float32]]:
    """(T0, K, 2) px of each clip that has so many frames, all of them tracked."""
    known = tracks.by_clip(table)
    lacking = [name for name in names if name not in known]
    if lacking:
        raise InputError(clips.folder / TABLE, f"no tracks of clip {lacking[0]}", "make the tracks again")
    starts = {name: known[name][:seen_frames] for name in names}
    return {name: xy for name, xy in starts.items() if len(xy) == seen_frames and np.isfinite(xy).all()}


def _forecast_batch(
    predictor: Predictor, clips: ClipSet, names: list[str], starts: dict[str, NDArray[np.float32]], last: int
) -> Forecast:
    T0 = predictor.seen_frames
    seen = [*range(T0), last] if predictor.sees_end else list(range(T0))
    frames = as_input(np.stack([clips.frames(name)[seen] for name in names]))
    xy = torch.from_numpy(np.stack([starts[name] for name in names])).to(device())
    times = torch.arange(last + 1, dtype=torch.float32, device=device()).expand(len(names), -1)
    predictor.to(device()).eval()
    with torch.no_grad():
        return predictor.forecast(Seen(frames, xy, times[:, seen]), times[:, T0:])


def _rows(clip: str, seen_frames: int, stop: int, found: Forecast, i: int) -> pd.DataFrame:
    count = stop - seen_frames
    cov = None if found.cov is None else found.cov[i, :count].cpu().numpy()
    return forecasts.rows(clip, seen_frames, found.mean[i, :count].cpu().numpy(), cov)
