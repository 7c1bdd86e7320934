import math

import torch
from springs import STATE, distances_by_learning, losses_by_learning, springs
from torch import Tensor
from torch.distributions import MultivariateNormal

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.probnet import ProbNet, ProbNetParams

LEAST, MOST = 0.25, 40.0


def probnet(distance_steps: int = 0, **changed: object) -> ProbNet:
    torch.manual_seed(0)
    sizes = {**STATE, "least_std_px": LEAST, "largest_std_px": MOST, "distance_steps": distance_steps, **changed}
    return ProbNet(ProbNetParams(**sizes), objects=1)


def test_the_loss_is_the_mean_distance_first_and_then_the_likelihood_of_torch():
    window, net = springs(clips=3, frames=9), probnet(distance_steps=2, symmetric=False)
    torch.nn.init.normal_(net.spread[-1].weight)
    forecast = net(window.seen, window.asked_times)
    distance = (forecast.mean - window.target).norm(dim=-1).mean().item()
    density = MultivariateNormal(forecast.mean.double(), forecast.cov.double())
    nats = -density.log_prob(window.target.double()).mean().item()
    losses = [net.loss(window, torch_generator(0))[0].item() for _ in range(4)]
    torch.testing.assert_close(torch.tensor(losses), torch.tensor([distance, distance, nats, nats]), rtol=1e-3, atol=0)
    assert math.isclose(net.validation_loss(window).item(), nats, rel_tol=1e-3)


def test_the_count_of_steps_is_kept_with_the_weights():
    window, net = springs(clips=2, frames=8), probnet(distance_steps=1)
    net.loss(window, torch_generator(0))
    other = probnet(distance_steps=1)
    other.load_state_dict(net.state_dict())
    assert other.steps == 1


def test_deviations_stay_within_their_bounds():
    window, net = springs(clips=2, frames=30), probnet(symmetric=False)
    torch.nn.init.normal_(net.spread[-1].weight, std=1e4)
    cov = net(window.seen, window.asked_times).cov
    half, det = cov.diagonal(dim1=-2, dim2=-1).sum(-1).double() / 2, torch.linalg.det(cov.double())
    most = half + (half.square() - det).clamp(min=0).sqrt()
    torch.testing.assert_close(most.max(), torch.tensor(MOST**2).double(), rtol=1e-3, atol=0)  # px^2
    assert (det / most).min() > 0.9 * LEAST**2  # px^2, the smaller eigenvalue


def test_one_batch_is_learned_twenty_fold_and_more_surely():
    window, net = springs(clips=4, frames=12), probnet(distance_steps=150, symmetric=False)
    unsure = net.validation_loss(window).item()
    before, after = distances_by_learning(net, window, steps=300)
    assert after < before / 20
    assert net.validation_loss(window) < unsure - math.log(20)  # nats: a deviation 1/20 along each of two directions


def blown(clips: int, generator: torch.Generator) -> Window:
    """Balls at rest, blown about from the last seen frame on by 2 px along x and 0.7 px along y a root of a frame."""
    xy = torch.tensor([8.0, 8.0]) + 16 * torch.rand(clips, 1, 1, 2, generator=generator)
    gusts = torch.randn(clips, 3, 1, 2, generator=generator) * torch.tensor([2.0, 0.7])
    times = torch.arange(7.0).expand(clips, -1)
    film = torch.zeros(clips, 4, 3, 32, 48)
    track = torch.cat([xy.expand(-1, 4, -1, -1), xy + gusts.cumsum(1)], dim=1)
    return Window(Seen(film, track[:, :4], times[:, :4]), times[:, 4:], track[:, 4:], 80.0, track)


def deviations(values: Tensor) -> Tensor:
    """(N, 2) root mean square over clips of (B, N, 1, 2)."""
    return values.square().mean((0, 2)).sqrt()


def test_predicted_deviations_are_the_real_errors_within_a_fifth():
    net = probnet(distance_steps=50, symmetric=False, channels=8)
    losses_by_learning(net, lambda step: blown(64, torch_generator(0, step)), 300, rate=1e-2)
    fresh = blown(1000, torch_generator(1))
    with torch.no_grad():
        forecast = net(fresh.seen, fresh.asked_times)
    predicted = forecast.cov.diagonal(dim1=-2, dim2=-1).mean((0, 2)).sqrt()
    real = deviations(forecast.mean - fresh.target)
    torch.testing.assert_close(predicted, real, rtol=0.2, atol=0)
    expected = torch.tensor([[2.0, 0.7]]) * torch.arange(1, 4)[:, None].sqrt()
    torch.testing.assert_close(real, expected, rtol=0.2, atol=0)  # what no forecast can do without
