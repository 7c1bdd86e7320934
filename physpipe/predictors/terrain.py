"""Terrain: acceleration read from a map of the environment at the place where the object is forecast to be (ours).

The environment is encoded once from the seen frames into a map. At every step the map is read at the predicted
position, a small network gives the law of motion there, and velocity and position follow: v += a, p += v. What the
paper's conclusion asks for: the environment is remembered however long the forecast, and only the motion is propagated.
Objects that meet push each other, and cushions push what runs into them. The camera's own motion is taken off the seen
positions, where it sways to is added to the forecast ones, and a forecast says how sure it is.

Learned from forecasts alone the law gets stuck where it is right on the whole and nowhere in particular. So it is first
matched, place by place, to the changes of velocity along smoothed tracks; then whole forecasts are trained, too.
Looking at the ground takes longest: each look serves all of the clip's track, and forecasts of several stretches of it.
"""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from physpipe.predictors.base import Forecast, Predictor, Seen, Window, distance_px
from physpipe.predictors.course import Course, stretches
from physpipe.predictors.kinematics import at, mended, odd, past
from physpipe.predictors.layers import FrameUnit, zero_reader
from physpipe.predictors.steadying import camera_path, steadied
from physpipe.predictors.sway import Sway
from physpipe.predictors.symmetry import mean_over_symmetries
from physpipe.predictors.terrain_law import Law, Motion, Scene, read
from physpipe.predictors.terrain_map import TerrainMap
from physpipe.predictors.terrain_params import TerrainParams
from physpipe.predictors.uncertainty import Spread, around, carried


class Terrain(Predictor):
    """Any number of objects, any frame of 16 px or more a side; asked times are whole frames after the last seen.

    Permuting the objects permutes the forecast.
    """

    Params = TerrainParams
    seen_frames = 4
    steadies = True
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
        self.sway = Sway(self.seen_frames)
        self.spread = Spread()
        self.register_buffer("steps", torch.tensor(0))

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        steady = steadied(seen)  # once, and not for every mirror
        mean = self._swayed(seen, asked_times, self._shown(steady, asked_times))
        if self.training or not self.params.spread_rounds:
            return Forecast(mean)
        cov = self.spread(self._carried(steady, asked_times)) * FrameUnit.of(seen.frames).px ** 2
        return Forecast(mean, at(cov, _ahead(seen, asked_times)))

    def watch(self, camera: Sequence[Tensor]) -> None:
        """Learns where a camera sways to."""
        self.sway.fit(camera)

    def loss(self, batch: Window, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        """How far off the law is along the tracks, in pixels a frame squared; then that of forecasts in pixels, too."""
        scene, places = self._look(steadied(batch.seen))
        unit = FrameUnit.of(batch.seen.frames)
        track = unit.from_px(batch.track)
        course = Course.of(track, odd(self.params.smoothing_s * batch.frames_per_s), self.law, scene)
        mismatch = course.mismatch(self.law, scene, unit.px)
        parts = {"train_change_px": mismatch.item()}
        stretch = torch.cat([places, unit.from_px(batch.target)], dim=1)
        more = stretches(track, stretch.shape[1], self.params.stretches, generator)
        every = torch.cat([stretch.unsqueeze(1), more], dim=1)
        self.steps += 1
        if self.steps <= self.params.matched_steps:
            return mismatch + self.law.see(scene.repeated(every.shape[1]), every.flatten(0, 1)), parts
        off = self._off(scene, every, batch.seen.times, unit.px)
        parts["train_last_px"] = off[:, -1, 0].mean().item()
        return off.mean() + self.params.matched_weight_s2 * batch.frames_per_s**2 * mismatch, parts

    def _off(self, scene: Scene, every: Tensor, times: Tensor, px: Tensor) -> Tensor:
        """(B, N, M, K) px that forecasts of stretches (B, M, T0 + N, K, 2), their frames at `times`, are off."""
        M, T0 = every.shape[1], self.seen_frames
        seen, later = every[:, :, :T0].flatten(0, 1), every[:, :, T0:].movedim(1, 2)
        begun = self._begin(scene.repeated(M), seen, times.repeat_interleave(M, 0))
        now = Motion(*(each.unflatten(0, (-1, M)).squeeze(2) for each in begun))
        return distance_px(px * self._roll(scene, now, later.shape[1]), px * later)

    def calibrate(self, held_out: Window) -> None:
        """Fits the covariance, which is of no use before."""
        if self.params.spread_rounds:
            seen, times = steadied(held_out.seen), held_out.asked_times
            shown = self._swayed(held_out.seen, times, self._shown(seen, times))
            missed = (held_out.target - shown) / FrameUnit.of(seen.frames).px
            self.spread.fit(self._carried(seen, times), missed, self.params.spread_rounds)

    def _swayed(self, seen: Seen, asked_times: Tensor, places: Tensor) -> Tensor:
        """`places` (B, N, K, 2) px of a still camera as the one of the film will show them, unless that is still."""
        if seen.steady:
            return places
        return places + self.sway(camera_path(seen.frames), _ahead(seen, asked_times)).unsqueeze(2)

    def _shown(self, seen: Seen, asked_times: Tensor) -> Tensor:
        """(B, N, K, 2) px, what a forecast shows of steady positions."""
        if self.training or not self.params.symmetric:
            return self._forecast(seen, asked_times).mean
        return mean_over_symmetries(self._forecast, seen, asked_times).mean

    def _forecast(self, seen: Seen, asked_times: Tensor) -> Forecast:
        scene, places = self._look(seen)
        ahead = _ahead(seen, asked_times)
        path = self._roll(scene, self._begin(scene, places, seen.times), int(ahead.max())).squeeze(2)
        return Forecast(FrameUnit.of(seen.frames).to_px(at(path, ahead)))

    def _roll(self, scene: Scene, now: Motion, steps: int) -> Tensor:
        """(B, steps, M, K, 2) where the objects are, one frame after the other."""
        path = []
        for _ in range(steps):
            now = self.law(scene, now)
            path.append(now.place)
        return torch.stack(path, dim=1)

    def _carried(self, seen: Seen, asked_times: Tensor) -> Tensor:
        """What errors of the start change, frame by frame to the last asked time."""
        scene, places = self._look(seen)
        starts = around(self._begin(scene, places, seen.times))
        return carried(self._roll(scene, starts, int(_ahead(seen, asked_times).max())))

    def _look(self, seen: Seen) -> tuple[Scene, Tensor]:
        """The scene, and the places (B, T0, K, 2) of what is seen steadily."""
        unit = FrameUnit.of(seen.frames)
        ground, whole = self.map(seen.frames, unit.aspect)
        places = unit.from_px(seen.xy)
        here = read(ground, places[:, -1:], unit.aspect)[:, 0]
        return Scene(ground, whole, self.describe(here).float(), unit.aspect), places

    def _begin(self, scene: Scene, places: Tensor, times: Tensor) -> Motion:
        """The last seen positions and velocities: the tracks' own, mended by what is seen; and what slides already."""
        here = read(scene.map, places[:, -1:], scene.aspect)[:, 0]
        places, sliding = self.law.turned(scene, places)
        told = [here, scene.whole.unsqueeze(1).expand(-1, self.objects, -1), past(places)]
        place, velocity = mended(self.start(torch.cat(told, dim=2)), places, times)
        return Motion(place.unsqueeze(1), velocity.unsqueeze(1), sliding.unsqueeze(1))


def _ahead(seen: Seen, asked_times: Tensor) -> Tensor:
    """(B, N) frames from the last seen one."""
    return (asked_times - seen.times[:, -1:]).long()
