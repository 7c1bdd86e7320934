"""What holds for every predictor of the zoo, found from the list of its members."""

import dataclasses

import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.core.horizon import BASELINES
from physpipe.predictors import PREDICTORS
from physpipe.predictors.base import Predictor, Seen, Window
from physpipe.predictors.ifs import IfsParams
from physpipe.predictors.interpnet import InterpNetParams
from physpipe.predictors.polynomial import NoParams
from physpipe.predictors.probnet import ProbNetParams
from physpipe.predictors.tensor_state import TensorStateParams
from physpipe.predictors.terrain_params import TerrainParams
from physpipe.predictors.vin import VinParams

HEIGHT, WIDTH, OBJECTS = 32, 48, 3
STATE = {"stem": 8, "channels": 8, "hidden": 8, "follow": True, "symmetric": True, "objects_alike": True}
SMALL = {
    "persistence": NoParams(),
    "linear": NoParams(),
    "quadratic": NoParams(),
    "posnet": TensorStateParams(**STATE),
    "dispnet": TensorStateParams(**STATE),
    "probnet": ProbNetParams(**STATE, least_std_px=0.25, largest_std_px=40.0, distance_steps=0),
    "interpnet": InterpNetParams(**STATE, first_state=1.0),
    "vin": VinParams(channels=4, code=8, hidden=8, seen_weight=0, velocity_weight=0),
    "ifs": IfsParams(hidden=8, velocity=True),
    "terrain": TerrainParams(
        channels=16,
        hidden=8,
        code=2,
        matched_steps=0,
        matched_weight_s2=1,
        stretches=1,
        smoothing_s=0.06,
        spread_rounds=8,
        symmetric=True,
    ),
}


def random_window(kind: type[Predictor], frames: int, clips: int = 2) -> Window:
    """Noise for film, drifting objects."""
    generator = torch_generator(0)
    seen = [*range(kind.seen_frames), *([frames - 1] if kind.sees_end else [])]
    film = torch.rand(clips, len(seen), 3, HEIGHT, WIDTH, generator=generator)
    moves = torch.randn(clips, frames, OBJECTS, 2, generator=generator).cumsum(1)
    xy = torch.tensor([WIDTH, HEIGHT]) / 2 + moves
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    known, asked = slice(kind.seen_frames), slice(kind.seen_frames, None)
    return Window(Seen(film, xy[:, known], times[:, seen]), times[:, asked], xy[:, asked], 80.0, xy)


def built(name: str, **changed: object) -> Predictor:
    """A small one with drawn weights, so that every part of it counts."""
    torch.manual_seed(0)
    made = PREDICTORS[name](SMALL[name].model_copy(update=changed), OBJECTS).eval()
    with torch.no_grad():
        for weights in made.parameters():
            weights.add_(0.05 * torch.randn(weights.shape))
    return made


@pytest.fixture(params=PREDICTORS)
def predictor(request: pytest.FixtureRequest) -> Predictor:
    return built(request.param)


def test_every_predictor_is_configured_here():
    kinds = {name: type(params) for name, params in SMALL.items()}
    assert kinds == {name: kind.Params for name, kind in PREDICTORS.items()}
    assert set(BASELINES) <= set(PREDICTORS)


def test_a_forecast_holds_a_finite_position_for_every_time_and_object(predictor):
    window = random_window(type(predictor), frames=40)
    forecast = predictor(window.seen, window.asked_times)
    assert forecast.mean.shape == window.target.shape
    assert forecast.mean.isfinite().all()


def test_a_clip_is_forecast_the_same_alone_or_in_company(predictor):
    window = random_window(type(predictor), frames=20)
    seen = window.seen
    alone = Seen(seen.frames[:1], seen.xy[:1], seen.times[:1])
    together = predictor(window.seen, window.asked_times).mean[:1]
    torch.testing.assert_close(predictor(alone, window.asked_times[:1]).mean, together, rtol=0, atol=1e-3)  # px


def test_a_time_is_forecast_the_same_whatever_else_is_asked(predictor):
    window = random_window(type(predictor), frames=20)
    chosen = torch.tensor([7, 0, 3])
    some = predictor(window.seen, window.asked_times[:, chosen]).mean
    every = predictor(window.seen, window.asked_times).mean
    torch.testing.assert_close(some, every[:, chosen], rtol=0, atol=1e-3)  # px


def test_a_covariance_is_one_for_every_time_and_object(predictor):
    window = random_window(type(predictor), frames=40)
    forecast = predictor(window.seen, window.asked_times)
    if forecast.cov is not None:
        assert forecast.cov.shape == (*window.target.shape, 2)
        torch.testing.assert_close(forecast.cov, forecast.cov.mT)
        assert (torch.linalg.eigvalsh(forecast.cov) > 0).all()


@pytest.mark.parametrize("name", [name for name in PREDICTORS if built(name).objects_alike])
def test_permuting_objects_that_are_alike_permutes_the_forecast(name):
    predictor, order = built(name), torch.tensor([2, 0, 1])
    window = random_window(type(predictor), frames=20)
    other = dataclasses.replace(window.seen, xy=window.seen.xy[:, :, order])
    expected, found = predictor(window.seen, window.asked_times), predictor(other, window.asked_times)
    torch.testing.assert_close(found.mean, expected.mean[:, :, order], rtol=0, atol=1e-3)  # px
    if expected.cov is not None:
        torch.testing.assert_close(found.cov, expected.cov[:, :, order], rtol=1e-3, atol=1e-3)


def test_every_loss_teaches_and_tells_how_far_off_the_last_position_is(predictor):
    window = random_window(type(predictor), frames=20)
    loss, parts = predictor.train().loss(window, torch_generator(0))
    missed = (predictor(window.seen, window.asked_times).mean - window.target).norm(dim=-1)
    assert parts["train_last_px"] == pytest.approx(missed[:, -1].mean().item(), abs=1e-3)
    assert loss.shape == ()
    if any(True for _ in predictor.parameters()):
        loss.backward()
        grads = [weights.grad for weights in predictor.parameters() if weights.grad is not None]
        assert all(grad.isfinite().all() for grad in grads)
        assert any(grad.any() for grad in grads)


@pytest.mark.parametrize("name", [name for name, kind in PREDICTORS.items() if kind.loss is Predictor.loss])
def test_a_loss_that_is_not_its_own_is_the_mean_distance_in_pixels(name):
    predictor = built(name)
    window = random_window(type(predictor), frames=20)
    loss, _ = predictor.train().loss(window, torch_generator(0))
    missed = (predictor(window.seen, window.asked_times).mean - window.target).norm(dim=-1)
    assert loss.item() == pytest.approx(missed.mean().item(), abs=1e-3)  # px: what guards the gradient at 0 may add


@pytest.mark.parametrize(
    "name", [name for name, kind in PREDICTORS.items() if kind.validation_loss is Predictor.validation_loss]
)
def test_a_validation_that_is_not_its_own_is_the_mean_distance_at_the_last_time(name):
    predictor = built(name)
    window = random_window(type(predictor), frames=20)
    missed = (predictor(window.seen, window.asked_times).mean - window.target).norm(dim=-1)[:, -1]
    assert predictor.validation_loss(window).item() == pytest.approx(missed.mean().item(), abs=1e-3)
