"""Terrain: acceleration read from a map of the environment at the place where the object is forecast to be (ours).

The environment is encoded once from the seen frames into a map. At every step the map is read at the predicted
position, a small network gives the law of motion there, and velocity and position follow: v += a, p += v. What the
paper's conclusion asks for: the environment is remembered however long the forecast, and only the motion is propagated.
The camera's own motion is taken off the seen positions, and a forecast says how sure it is. A clip is taken to begin
where the objects are let go, without spin.
"""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen, Window
from physpipe.predictors.kinematics import at, mended, past
from physpipe.predictors.layers import FrameUnit, zero_reader
from physpipe.predictors.steadying import camera_shifts
from physpipe.predictors.symmetry import mean_over_symmetries
from physpipe.predictors.terrain_law import Law, Motion, Scene, read
from physpipe.predictors.terrain_map import TerrainMap
from physpipe.predictors.uncertainty import Path, Spread, linearised


class TerrainParams(Section):
    """Sizes of the network, and how it learns."""

    channels: int = Field(ge=16, multiple_of=16)
    """Channels of the map, at 1/8 of the frame's size."""
    hidden: int = Field(ge=1)
    """Width of the layers of the laws of motion."""
    code: int = Field(ge=1)
    """Numbers that describe an object."""
    first_horizon: int = Field(ge=1)
    """Frames forecast in the first steps of training."""
    growth_steps: int = Field(ge=0)
    """Training steps over which that horizon grows to all that are asked for; 0 = all at once."""
    spread_rounds: int = Field(ge=0)
    """Steps of fitting the covariance; 0 = forecasts have none."""
    symmetric: bool
    """Whether a forecast is the mean over all mirrors and turns of the frame; training sees one at a time."""


class Terrain(Predictor):
    """Any number of objects, any frame of 16 px or more a side; asked times are whole frames after the last seen.

    Permuting the objects permutes the forecast.
    """

    Params = TerrainParams
    seen_frames = 4
    sees_past = True
    objects_alike = True
    steps: Tensor

    def __init__(self, params: TerrainParams, objects: int):
        super().__init__(params, objects)
        self.params = params
        C, hidden, code = params.channels, params.hidden, params.code
        self.map = TerrainMap(C)
        self.describe = nn.Linear(C, code)
        self.start = zero_reader(2 * C + 4 * self.seen_frames, hidden, 2 * (self.seen_frames + 1), nn.SiLU)
        self.law = Law(C, C, code, hidden, pairs=objects > 1)
        self.spread = Spread(objects)
        self.register_buffer("steps", torch.tensor(0))

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        if self.training:
            return self._forecast(seen, asked_times)
        if self.params.symmetric:
            found = mean_over_symmetries(self._forecast, seen, asked_times)
        else:
            found = self._forecast(seen, asked_times)
        if not self.params.spread_rounds:
            return found
        cov = self.spread(self._path(seen, asked_times).jacobians) * FrameUnit.of(seen.frames).px ** 2
        return Forecast(found.mean, at(cov, _ahead(seen, asked_times)))

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """Mean distance in pixels over a horizon that grows while it learns: a far error teaches nothing at first."""
        asked = batch.asked_times.shape[1]
        grown = min(1.0, self.steps.item() / self.params.growth_steps) if self.params.growth_steps else 1.0
        count = min(asked, round(self.params.first_horizon + grown * (asked - self.params.first_horizon)))
        self.steps += 1
        near = Window(batch.seen, batch.asked_times[:, :count], batch.target[:, :count])
        return super().loss(near, generator)

    def calibrate(self, held_out: Window) -> None:
        """Fits the covariance, which is of no use before."""
        if self.params.spread_rounds:
            path = self._path(held_out.seen, held_out.asked_times)
            target = FrameUnit.of(held_out.seen.frames).from_px(held_out.target)
            self.spread.fit(path, target, self.params.spread_rounds)

    def _forecast(self, seen: Seen, asked_times: Tensor) -> Forecast:
        scene, now = self._begin(seen)
        path = []
        ahead = _ahead(seen, asked_times)
        for _ in range(int(ahead.max())):
            now = self.law(scene, now)
            path.append(now.place[:, 0])
        return Forecast(FrameUnit.of(seen.frames).to_px(at(torch.stack(path, dim=1), ahead)))

    def _path(self, seen: Seen, asked_times: Tensor) -> Path:
        """To the last asked time, frame by frame."""
        scene, now = self._begin(seen)
        return linearised(lambda motion: self.law(scene, motion), now, int(_ahead(seen, asked_times).max()))

    def _begin(self, seen: Seen) -> tuple[Scene, Motion]:
        """The scene, and the last seen position and velocity: the tracks' own, mended by what is seen."""
        unit = FrameUnit.of(seen.frames)
        places = unit.from_px(seen.xy - camera_shifts(seen.frames).unsqueeze(2))  # (B, T0, K, 2)
        ground, whole = self.map(seen.frames, unit.aspect)
        here = read(ground, places[:, -1:], unit.aspect)[:, 0]
        told = [here, whole.unsqueeze(1).expand(-1, self.objects, -1), past(places)]
        place, velocity = mended(self.start(torch.cat(told, dim=2)), places, seen.times)
        scene = Scene(ground, whole, self.describe(here).float(), unit.aspect)
        since_release = places if seen.earlier is None else torch.cat([unit.from_px(seen.earlier), places], dim=1)
        now = Motion(place, velocity, self.law.spun(scene, since_release))
        return scene, Motion(*(each.unsqueeze(1) for each in now))


def _ahead(seen: Seen, asked_times: Tensor) -> Tensor:
    """(B, N) frames from the last seen one."""
    return (asked_times - seen.times[:, -1:]).long()
