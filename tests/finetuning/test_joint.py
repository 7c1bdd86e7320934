"""Tracker and predictor are drawn to each other: exact cross-entropies, and gradients that reach both."""

import math

import numpy as np
import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.finetuning.joint import ELSEWHERE, AgreementParams, Joint, prior_cross_entropy
from physpipe.finetuning.stretches import Batch, draw, evenly
from physpipe.predictor_learning.windows import TrackWindows, WindowParams
from physpipe.tracker_learning.lesson import lesson

STRIDE = 4  # pixels a cell: cell i has its centre at 4 i + 1.5
APART = AgreementParams(looks=2, window_px=6, consistency=1.0, prior=0.0, prior_px=4.0)
PRIOR = APART.model_copy(update={"consistency": 0.0, "prior": 1.0})


def peak(row: int, column: int) -> torch.Tensor:
    """(1, 6, 8): all of a heat map in one cell."""
    heat = torch.zeros(1, 6, 8)
    heat[0, row, column] = 1
    return heat


def windows(pair, split="train", horizon=8) -> TrackWindows:
    return TrackWindows(pair.clips, pair.table, split, pair.predictor.seen_frames, horizon)


def batch(pair) -> Batch:
    task, train = lesson(pair.clips, pair.tracker), windows(pair)
    window = train.draw(4, WindowParams(noise_px=0, first_share=0, valid_windows=1), torch_generator(0))
    return Batch(task.train(torch_generator(0)), window, draw(train, 4, 2, torch_generator(0)))


def test_a_heat_map_where_an_object_is_forecast_costs_nothing():
    at = torch.tensor([[[9.5, 5.5]]])  # (1 map, 1 object, x and y): the centre of column 2, row 1
    assert prior_cross_entropy(peak(1, 2), STRIDE, at, 4.0).item() == pytest.approx(-math.log(1 + ELSEWHERE), abs=1e-6)


def test_a_cell_further_costs_as_a_gaussian_says():
    at = torch.tensor([[[9.5, 5.5]]])
    bump = math.exp(-(4**2) / (2 * 4.0**2))
    for row, column in ((1, 3), (2, 2)):
        found = prior_cross_entropy(peak(row, column), STRIDE, at, 4.0).item()
        assert found == pytest.approx(-math.log(bump + ELSEWHERE), rel=1e-5)


def test_with_several_objects_the_nearest_forecast_counts():
    at = torch.tensor([[[9.5, 5.5], [29.5, 21.5]]])
    for row, column in ((1, 2), (5, 7)):
        assert prior_cross_entropy(peak(row, column), STRIDE, at, 4.0).item() == pytest.approx(0, abs=2e-3)  # nats


def drawn_by(pair, params: AgreementParams, without: AgreementParams) -> set[str]:
    """Which of the two, `net` and `predictor`, have another gradient by `params` than `without` them."""
    state = {name: value.clone() for name, value in pair.net.state_dict().items()}
    names, slopes = [], []
    for each in (params, without):
        joint = Joint(pair.net, pair.predictor, each).eval()
        names = [name.split(".")[0] for name, _ in joint.named_parameters()]
        loss, _ = joint.loss(batch(pair), torch_generator(3))
        slopes.append(torch.autograd.grad(loss, [*joint.parameters()], allow_unused=True))
        pair.net.load_state_dict(state)  # the noise on positions grows with every step
    pairs = zip(names, *slopes, strict=True)
    return {name for name, one, other in pairs if one is not None and not torch.allclose(one, other, atol=1e-6)}


def test_the_distance_draws_both_and_the_prior_the_detector_alone(pair):
    nothing = APART.model_copy(update={"consistency": 0.0})
    assert drawn_by(pair, APART, nothing) == {"net", "predictor"}
    assert drawn_by(pair, PRIOR, nothing) == {"net"}


def test_the_loss_is_the_sum_of_its_parts_by_their_weights(pair):
    drawn = batch(pair)

    def of(consistency: float, prior: float) -> tuple[float, dict[str, float]]:
        params = APART.model_copy(update={"consistency": consistency, "prior": prior})
        loss, parts = Joint(pair.net, pair.predictor, params).eval().loss(drawn, torch_generator(3))
        return loss.item(), parts

    state = {name: value.clone() for name, value in pair.net.state_dict().items()}
    own, parts = of(0, 0)
    pair.net.load_state_dict(state)  # the noise on positions grows with every step
    both, _ = of(0.5, 0.25)
    pair.net.load_state_dict(state)
    assert both == pytest.approx(own + 0.5 * parts["apart_px"] + 0.25 * parts["prior_nats"], rel=1e-5)


def test_what_is_found_lies_where_the_tracks_are(pair):
    joint = Joint(pair.net, pair.predictor, APART).eval()
    stretch = draw(windows(pair), 6, 2, torch_generator(1))
    with torch.no_grad():
        _, found = joint.find(stretch)
    assert found.shape == stretch.xy.shape
    assert (found - stretch.xy).norm(dim=-1).mean() < 1.5  # pixels: the tracks are of this detector


def test_stretches_show_the_frames_that_they_say(pair):
    known = windows(pair, "valid")
    (stretch,) = evenly(known, 3, 2, together=8)
    assert stretch.looks.tolist() == [2, 4]  # of the five after the four seen ones, to the last
    numbers = known.evenly(3)
    assert len(stretch.frames) == len(numbers)
    for at, number in enumerate(numbers):
        clip, first = known.index[number]
        for look, time in enumerate(stretch.times[at].tolist()):
            film = known.frames[clip][first + int(time)]
            np.testing.assert_allclose(stretch.frames[at, look].permute(1, 2, 0).numpy(), film / 255, atol=1e-6)
            np.testing.assert_array_equal(stretch.xy[at, look].numpy(), known.xy[clip][first + int(time)])


def test_every_frame_after_the_seen_ones_is_looked_at(pair):
    known = windows(pair)
    drawn = {look for n in range(40) for look in draw(known, 1, 2, torch_generator(n)).looks.tolist()}
    assert drawn == set(range(9 - pair.predictor.seen_frames))
