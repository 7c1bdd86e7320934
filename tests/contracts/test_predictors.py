"""What holds for every predictor of the zoo, found from the list of its members."""

import dataclasses

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.predictors import PREDICTORS
from physpipe.predictors.base import Predictor, Seen, Window
from physpipe.predictors.dispnet import DispNetParams
from physpipe.predictors.horizon import BASELINES
from physpipe.predictors.ifs import IfsParams
from physpipe.predictors.polynomial import NoParams
from physpipe.predictors.vin import VinParams

HEIGHT, WIDTH, OBJECTS = 32, 48, 3
SMALL = {
    "persistence": NoParams(),
    "linear": NoParams(),
    "quadratic": NoParams(),
    "dispnet": DispNetParams(stem=8, channels=8, hidden=8, follow=True, symmetric=True),
    "vin": VinParams(channels=4, code=8, hidden=8, seen_weight=0, velocity_weight=0),
    "ifs": IfsParams(hidden=8, velocity=True),
}


def random_window(seen_frames: int, frames: int, clips: int = 2) -> Window:
    """Noise for film, drifting objects."""
    generator = torch_generator(0)
    film = torch.rand(clips, seen_frames, 3, HEIGHT, WIDTH, generator=generator)
    moves = torch.randn(clips, frames, OBJECTS, 2, generator=generator).cumsum(1)
    xy = torch.tensor([WIDTH, HEIGHT]) / 2 + moves
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    return Window(Seen(film, xy[:, :seen_frames], times[:, :seen_frames]), times[:, seen_frames:], xy[:, seen_frames:])


@pytest.fixture(params=PREDICTORS)
def predictor(request: pytest.FixtureRequest) -> Predictor:
    """A small one with drawn weights, so that every part of it counts."""
    torch.manual_seed(0)
    made = PREDICTORS[request.param](SMALL[request.param], OBJECTS).eval()
    with torch.no_grad():
        for weights in made.parameters():
            weights.add_(0.05 * torch.randn(weights.shape))
    return made


def test_every_predictor_is_configured_here():
    kinds = {name: type(params) for name, params in SMALL.items()}
    assert kinds == {name: kind.Params for name, kind in PREDICTORS.items()}
    assert set(BASELINES) <= set(PREDICTORS)


def test_a_forecast_holds_a_finite_position_for_every_time_and_object(predictor):
    window = random_window(predictor.seen_frames, frames=40)
    forecast = predictor(window.seen, window.asked_times)
    assert forecast.mean.shape == window.target.shape
    assert forecast.mean.isfinite().all()


def test_a_clip_is_forecast_the_same_alone_or_in_company(predictor):
    window = random_window(predictor.seen_frames, frames=20)
    alone = Seen(*(getattr(window.seen, part.name)[:1] for part in dataclasses.fields(Seen)))
    together = predictor(window.seen, window.asked_times).mean[:1]
    torch.testing.assert_close(predictor(alone, window.asked_times[:1]).mean, together, rtol=0, atol=1e-3)  # px


def test_a_time_is_forecast_the_same_whatever_else_is_asked(predictor):
    window = random_window(predictor.seen_frames, frames=20)
    chosen = torch.tensor([7, 0, 3])
    some = predictor(window.seen, window.asked_times[:, chosen]).mean
    every = predictor(window.seen, window.asked_times).mean
    torch.testing.assert_close(some, every[:, chosen], rtol=0, atol=1e-3)  # px


def test_the_loss_is_the_mean_distance_in_pixels(predictor):
    window = random_window(predictor.seen_frames, frames=20)
    loss, parts = predictor.loss(window, torch_generator(0))
    missed = (predictor(window.seen, window.asked_times).mean - window.target).norm(dim=-1)
    assert loss.item() == pytest.approx(missed.mean().item(), abs=1e-3)  # px: what guards the gradient at 0 may add
    assert parts["train_last_px"] == pytest.approx(missed[:, -1].mean().item(), abs=1e-3)
