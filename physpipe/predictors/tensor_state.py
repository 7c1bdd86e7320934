"""What PosNet, DispNet, ProbNet and InterpNet share: a state that is a tensor over the frame, propagated step by step.

Ehrhardt et al. 2018, section 3.2, after "Learning a physical long-term predictor" (arXiv 1703.00247) and "Learning to
represent mechanics via long-term extrapolation and interpolation" (arXiv 1706.02179). Theirs: four frames in, a state
that keeps the layout of the frame, one propagation layer used at every step, positions or displacements regressed from
the state. The paper does not print the layers, so all sizes are ours. Ours too:

- what is read are the coefficients of a law of motion: the displacement changes by c + D d + Q(d, d), d being the
  displacement; on a terrain c is gravity's pull, D friction, Q what steers a path along a curved surface;
- the first displacement is a weighted sum of the seen positions, the weights being read from them too;
- the state of the last seen frame is shown again to every step, since a propagated state forgets the terrain;
- with `follow`, the predicted position is marked on the grid and the state read there;
- with `objects_alike`, objects share the weights that mark them, and their marks are averaged.
"""

from abc import abstractmethod
from typing import ClassVar, NamedTuple

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.predictors.base import Forecast, Predictor, Seen
from physpipe.predictors.kinematics import POWERS, SPEED, at, change, mended, past
from physpipe.predictors.layers import Residual, bilinear_weights, everywhere, offsets_from, read_at, zero_reader
from physpipe.predictors.scene import Scene, SceneEncoder, SceneParams, apart, together
from physpipe.predictors.symmetry import mean_over_symmetries


class TensorStateParams(SceneParams):
    """Sizes of the network (ours)."""

    hidden: int = Field(ge=1)
    """Width of the layers that read the state."""
    follow: bool
    """Whether the state is marked and read at the predicted position (ours), or always at the last seen one, so that
    the state alone carries the motion (as in the paper)."""
    symmetric: bool
    """Whether a forecast is the mean over all mirrors and turns of the frame (ours); training sees one at a time."""


class Motion(NamedTuple):
    """Of every object, in the unit of `FrameUnit`."""

    place: Tensor
    """(B, K, 2)."""
    displacement: Tensor
    """(B, K, 2) a frame."""
    step: int
    """Frames after the last seen one."""


class TensorState(Predictor):
    """Any number of objects; any frame of 16 px or more a side; asked times are whole frames after the last seen."""

    seen_frames = 4
    look_extra: ClassVar[int] = 0
    """Length of what a net of its own kind reads beside the state."""

    def __init__(self, params: TensorStateParams, objects: int):
        super().__init__(params, objects)
        C = params.channels
        self.follow, self.symmetric, self.objects_alike = params.follow, params.symmetric, params.objects_alike
        self.look_size = 3 * C + 4 + self.look_extra
        self.encode = SceneEncoder(params, objects, self.seen_frames + self.sees_end, self.seen_frames)
        self.remind = nn.Conv2d(C, C, 3, padding=1)
        self.mark = nn.Conv2d(5 if params.objects_alike else 5 * objects, C, 3, padding=1)
        self.propagate = Residual(C)
        self.start = zero_reader(2 * C + 4 * self.seen_frames, params.hidden, outputs=2 * (self.seen_frames + 1))
        self.law = zero_reader(self.look_size, params.hidden, outputs=2 * POWERS)

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        if self.symmetric and not self.training:
            return mean_over_symmetries(self._forecast, seen, asked_times)
        return self._forecast(seen, asked_times)

    def _forecast(self, seen: Seen, asked_times: Tensor) -> Forecast:
        return self._forecast_from(self._scene(seen), asked_times)

    def _scene(self, seen: Seen) -> Scene:
        return self.encode(seen)

    def _forecast_from(self, scene: Scene, asked_times: Tensor) -> Forecast:
        ahead = (asked_times - scene.last_time).long()  # (B, N) steps from the last seen position
        path, looks = self._roll(scene, int(ahead.max()))
        return self._answer(scene, at(path, ahead), at(looks, ahead), ahead)

    def _roll(self, scene: Scene, steps: int) -> tuple[Tensor, Tensor]:
        """(B, steps, K, 2) where the objects are, one frame after the other; (B, steps, K, L) what told it."""
        now = self._begin(scene)
        reminder, state = self.remind(scene.state), scene.state
        known = now
        path, looks = [], []
        for _ in range(steps):
            weights = bilinear_weights(known.place, scene.grid, scene.unit.aspect)
            state = self.propagate(state, reminder + self._told(scene, weights, known))
            looks.append(self._look(scene, state, weights, known))
            now = self._move(looks[-1], known, now)
            path.append(now.place)
            if self.follow:
                known = now
        return torch.stack(path, dim=1), torch.stack(looks, dim=1)

    def _told(self, scene: Scene, weights: Tensor, known: Motion) -> Tensor:
        """(B, C, h, w): what the state is told of the objects."""
        place, displacement = known.place, known.displacement
        if self.objects_alike:
            weights, place, displacement = weights.flatten(0, 1).unsqueeze(1), apart(place), apart(displacement)
        offsets = offsets_from(place, scene.grid, scene.unit.aspect)
        told = self.mark(torch.cat([weights, offsets, everywhere(displacement / SPEED, scene.grid)], dim=1))
        return together(told, self.objects) if self.objects_alike else told

    def _look(self, scene: Scene, state: Tensor, weights: Tensor, known: Motion) -> Tensor:
        """(B, K, L) what is read of each object."""
        mean = state.float().mean((2, 3)).unsqueeze(1).expand_as(scene.whole)
        read = [read_at(state, weights), mean, read_at(scene.state, weights)]
        return torch.cat([*read, known.place, known.displacement / SPEED], dim=2)

    def _begin(self, scene: Scene) -> Motion:
        """The tracks' own last position and displacement, mended by what is seen."""
        weights = bilinear_weights(scene.places[:, -1], scene.grid, scene.unit.aspect)
        read = [read_at(scene.state, weights), scene.whole, past(scene.places)]
        mend = self.start(torch.cat(read, dim=2))
        return Motion(*mended(mend, scene.places, scene.times[:, : scene.places.shape[1]]), step=0)

    def _change(self, look: Tensor, known: Motion) -> Tensor:
        """(B, K, 2) by which the displacement changes in a frame, by the law of motion that is read."""
        return change(self.law(look), known.displacement)

    @abstractmethod
    def _move(self, look: Tensor, known: Motion, now: Motion) -> Motion:
        """The motion one frame after `now`; `known` is what the state has been told."""

    def _answer(self, scene: Scene, path: Tensor, looks: Tensor, ahead: Tensor) -> Forecast:
        """The forecast `ahead` (B, N) frames after the last seen one, from `path` and `looks` there."""
        return Forecast(scene.unit.to_px(path))
