"""DispNet: a tensor state, propagated frame by frame by one convolutional layer, from which displacements are read.

Ehrhardt et al. 2018, section 3.2, after "Learning a physical long-term predictor" (arXiv 1703.00247). Theirs: four
frames in, a state that keeps the layout of the frame, one propagation layer used at every step, displacements
regressed from the state and added up. The paper does not print the layers, so all sizes are ours. Ours too:

- the seen positions enter beside the frames, as marks and coordinates on the grid;
- the state of the last seen frame is shown again to every step, since a propagated state forgets the terrain;
- with `follow`, the predicted position is marked on the grid and the state read there;
- what is read are the coefficients of a law of motion: the displacement changes by c + D d + Q(d, d), d being the
  displacement; on a terrain c is gravity's pull, D friction, Q what steers a path along a curved surface;
- the first displacement is a weighted sum of the seen positions, the weights being read from them too.
"""

import torch
from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.predictors.base import Forecast, Predictor, Seen
from physpipe.predictors.layers import Residual, bilinear_weights, normed_conv, offsets_from, read_at
from physpipe.predictors.symmetry import mean_over_symmetries

SPEED = 1 / 16
"""A lively displacement a frame, in halves of the frame's longer side; brings inputs near 1."""
CHANGE = 1 / 128
"""A lively change of it a frame; brings outputs near 1."""
FASTEST = 1.0
"""Largest displacement a frame, in halves of the frame's longer side: nothing that can be followed is as fast."""
WEIGHT = 0.3
"""A lively weight of a seen position; the least-squares slope through four has 0.3 at its ends."""
POWERS = 6
"""Terms of a quadratic form in a displacement: 1, x, y, x^2, x y, y^2."""


class DispNetParams(Section):
    """Sizes of the network (ours)."""

    stem: int = Field(ge=8, multiple_of=8)
    """Channels of the first convolution, at 1/4 of the frame's size."""
    channels: int = Field(ge=8, multiple_of=8)
    """Channels of the state, at 1/16 of the frame's size (8 x 8 for 128 px)."""
    hidden: int = Field(ge=1)
    """Width of the layers that read the state."""
    follow: bool
    """Whether the state is marked and read at the predicted position (ours), or always at the last seen one, so that
    the state alone carries the motion (as in the paper)."""
    symmetric: bool
    """Whether a forecast is the mean over all mirrors and turns of the frame (ours); training sees one at a time."""


class DispNet(Predictor):
    """Any number of objects; any frame of 16 px or more a side; asked times are whole frames after the last seen."""

    Params = DispNetParams
    seen_frames = 4

    def __init__(self, params: DispNetParams, objects: int):
        super().__init__(params, objects)
        C, K = params.channels, objects
        self.follow, self.symmetric = params.follow, params.symmetric
        self.stem = normed_conv(3 * self.seen_frames, params.stem, kernel=8, stride=4)
        self.middle = normed_conv(params.stem + (self.seen_frames + 4) * K, C, kernel=4, stride=2)
        self.top = nn.Sequential(normed_conv(C, C, kernel=4, stride=2), normed_conv(C, C, kernel=3, stride=1))
        self.remind = nn.Conv2d(C, C, 3, padding=1)
        self.mark = nn.Conv2d(5 * K, C, 3, padding=1)
        self.propagate = Residual(C)
        self.start = _reader(2 * C + 4 * self.seen_frames, params.hidden, outputs=2 * (self.seen_frames + 1))
        self.change = _reader(3 * C + 4, params.hidden, outputs=2 * POWERS)

    def forward(self, seen: Seen, asked_times: Tensor) -> Forecast:
        if self.symmetric and not self.training:
            return Forecast(mean_over_symmetries(self._forecast, seen, asked_times))
        return Forecast(self._forecast(seen, asked_times))

    def _forecast(self, seen: Seen, asked_times: Tensor) -> Tensor:
        """(B, N, K, 2) pixels."""
        size = torch.tensor(seen.frames.shape[:-3:-1], device=seen.xy.device)  # (width, height)
        unit, centre = size.max() / 2, (size - 1) / 2
        aspect = size / unit
        places = (seen.xy - centre) / unit  # (B, T0, K, 2) from the centre, half of the longer side = 1
        ahead = (asked_times - seen.times[:, -1:]).long()  # (B, N) steps from the last seen frame
        scene = self._encode(seen.frames, places, _velocity(places, seen.times), aspect)
        path = self._roll(scene, places, seen.times, int(ahead.max()), aspect)
        chosen = path[torch.arange(len(path), device=path.device)[:, None], ahead - 1]
        return chosen * unit + centre

    def _encode(self, frames: Tensor, places: Tensor, velocity: Tensor, aspect: Tensor) -> Tensor:
        """(B, C, h, w): what the seen frames and positions tell."""
        stacked = (frames - 0.5).flatten(1, 2).contiguous(memory_format=torch.channels_last)
        low = self.stem(stacked)
        grid = (low.shape[2], low.shape[3])
        marks = bilinear_weights(places.flatten(1, 2), grid, aspect)
        offsets = offsets_from(places[:, -1], grid, aspect)
        return self.top(self.middle(torch.cat([low, marks, offsets, _constant(velocity / SPEED, grid)], dim=1)))

    def _roll(self, scene: Tensor, places: Tensor, times: Tensor, steps: int, aspect: Tensor) -> Tensor:
        """(B, steps, K, 2): where the objects are, one frame after the other."""
        grid = (scene.shape[2], scene.shape[3])
        whole = scene.float().mean((2, 3)).unsqueeze(1).expand(-1, self.objects, -1)
        place, displacement = self._begin(scene, whole, places, times, aspect)
        reminder, state = self.remind(scene), scene
        mark, known = place, displacement
        path = []
        for _ in range(steps):
            weights = bilinear_weights(mark, grid, aspect)
            marks = [weights, offsets_from(mark, grid, aspect), _constant(known / SPEED, grid)]
            state = self.propagate(state, reminder + self.mark(torch.cat(marks, dim=1)))
            everywhere = state.float().mean((2, 3)).unsqueeze(1).expand_as(whole)
            read = [read_at(state, weights), everywhere, read_at(scene, weights), mark, known / SPEED]
            law = self.change(torch.cat(read, dim=2)).float().unflatten(2, (2, POWERS))
            displacement = displacement + CHANGE * (law @ _powers(known / SPEED).unsqueeze(3)).squeeze(3)
            displacement = displacement.clamp(-FASTEST, FASTEST)  # else the law's square term may run away
            place = place + displacement
            path.append(place)
            if self.follow:
                mark, known = place, displacement
        return torch.stack(path, dim=1)

    def _begin(
        self, scene: Tensor, whole: Tensor, places: Tensor, times: Tensor, aspect: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Last seen position and displacement a frame, (B, K, 2) each: the tracks' own, mended by what is seen."""
        last = places[:, -1]
        weights = bilinear_weights(last, (scene.shape[2], scene.shape[3]), aspect)
        past = ((places - last.unsqueeze(1)) / SPEED).transpose(1, 2).flatten(2)
        read = [read_at(scene, weights), whole, past, places.transpose(1, 2).flatten(2)]
        mend = self.start(torch.cat(read, dim=2)).float().unflatten(2, (2, self.seen_frames + 1))
        earlier = (places[:, :-1] - last.unsqueeze(1)).transpose(1, 2)  # (B, K, T0 - 1, 2)
        mended = CHANGE * mend[..., :2] + WEIGHT * mend[..., 2:] @ earlier  # (B, K, 2, 2): position, displacement
        return last + mended[:, :, 0], _velocity(places, times) + mended[:, :, 1]


def _velocity(places: Tensor, times: Tensor) -> Tensor:
    """(B, K, 2) slope of the least-squares line through `places` (B, T0, K, 2) at `times` (B, T0)."""
    centred = times - times.mean(1, keepdim=True)
    return torch.einsum("bt,btkd->bkd", centred / centred.square().sum(1, keepdim=True), places)


def _powers(displacement: Tensor) -> Tensor:
    """(..., POWERS) terms of a quadratic form in `displacement` (..., 2)."""
    x, y = displacement.unbind(-1)
    return torch.stack([torch.ones_like(x), x, y, x * x, x * y, y * y], dim=-1)


def _constant(values: Tensor, grid: tuple[int, int]) -> Tensor:
    """(B, K * D, h, w) maps that hold each of `values` (B, K, D) everywhere."""
    return values.flatten(1)[:, :, None, None].expand(-1, -1, *grid)


def _reader(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    """Two-layer perceptron that answers 0 before it has learned anything, so that learning starts from a line."""
    last = nn.Linear(hidden, outputs)
    nn.init.zeros_(last.weight)
    nn.init.zeros_(last.bias)
    hidden_layers = [nn.Linear(inputs, hidden), nn.ReLU(), nn.Linear(hidden, hidden), nn.ReLU()]
    return nn.Sequential(*hidden_layers, last)
