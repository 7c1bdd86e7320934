"""How much energy forecasts win or lose that the simulator's balls did not (ours; the paper looks at places only)."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.core.parallel import in_parallel
from physpipe.io import forecasts
from physpipe.io.clips import ClipSet
from physpipe.io.forecasts import ClipForecast
from physpipe.metrics.predictors import pairing
from physpipe.scenes.energy import energy_j, lifted
from physpipe.scenes.physics import PhysicsParams
from physpipe.scenes.world_params import WorldParams
from physpipe.scenes.worlds import Chances, World, draw_world, number_of
from physpipe.scoring.forecast_figures import MULTIPLES, Figures, mean_of_known

AROUND = np.arange(-2, 3)
"""Frames that tell the energy in the middle one."""
HORIZONS = ("T", "2T")
"""Keys of MULTIPLES at which it is told: forecasts end at 4 T, and none goes two frames further."""


class Replay:
    """A clip of a simulated set, its balls rolled again without being filmed."""

    def __init__(self, clips: ClipSet, clip: str, world: World, physics: PhysicsParams):
        rows = clips.rows(clip)
        self.world, self.physics, self.geometry = world, physics, clips.geometry(clip)
        self.moments = rows["source_frame"].to_numpy()
        """(T,) source frame of each of the clip's frames."""

    def drift(self, forecast: ClipForecast, frame: int) -> float:
        """Energy at `frame` of a forecast less the true one, over the true one where it begins.

        The true one, too, is that of the path alone. NaN where the forecast does not go two frames further.
        """
        around = frame + AROUND
        if around[0] < forecast.first or around[-1] >= min(len(self.moments), forecast.first + len(forecast.mean)):
            return np.nan
        begin = self.moments[forecast.first - 1]
        # The camera forecast on is that of the last frame seen.
        camera, scale = self.world.camera, self.world.camera.params.pixels_per_metre
        xy_m = (self.geometry.to_source(forecast.mean) - camera.centre - camera.wobble[begin]) / scale
        mine, theirs = pairing(xy_m[0], self.world.xyz_m[self.moments[forecast.first], :, :2])
        path = np.full((len(AROUND), len(self.world.balls), 2), np.nan)
        path[:, theirs] = xy_m[around - forecast.first][:, mine]
        true, start = self._true(frame), self._true(forecast.first)
        return (self._energy(lifted(self.world, path), frame) - true) / start

    def _true(self, frame: int) -> float:
        return self._energy(self.world.xyz_m[self.moments[frame + AROUND]], frame)

    def _energy(self, xyz_m: NDArray[np.float64], frame: int) -> float:
        source_frames = (self.moments[frame + 2] - self.moments[frame - 2]) / 4
        return energy_j(self.world, self.physics, xyz_m, source_frames / self.world.camera.params.fps)


def replays(params: WorldParams, name: str, clips: ClipSet, of: Sequence[str]) -> dict[str, Replay]:
    """Clip to its replay, for the clips `of` the simulated set `name`."""
    numbers = [number_of(str(clips.rows(clip)["source"].iloc[0])) for clip in of]
    worlds = in_parallel(partial(_again, params, name), numbers, f"roll {name} again")
    return {clip: Replay(clips, clip, world, params.physics) for clip, world in zip(of, worlds, strict=True)}


def _again(params: WorldParams, name: str, number: int) -> World:
    return draw_world(params, Chances.of(name, number))


def energy_figures(table: pd.DataFrame, known: Mapping[str, Replay], horizon: int) -> Figures:
    """`energy_drift_*`, the mean over clips, and `energy_off_*`, that of its size, at HORIZONS; NaN where no simulator
    knows.
    """
    paths = [(known[clip], path) for clip, path in forecasts.by_clip(table).items() if clip in known]
    figures: Figures = {}
    for name in HORIZONS:
        drifts = np.array([replay.drift(path, MULTIPLES[name] * horizon) for replay, path in paths])
        figures |= {f"energy_drift_{name}": mean_of_known(drifts), f"energy_off_{name}": mean_of_known(np.abs(drifts))}
    return figures
