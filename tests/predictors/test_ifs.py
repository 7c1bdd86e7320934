import pytest
import torch
from springs import losses_by_learning
from torch import Tensor, nn

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.ifs import Ifs, IfsParams

HEIGHT, WIDTH = 48, 64
FILM = torch.zeros(1, 4, 3, HEIGHT, WIDTH)


def ifs(objects: int, velocity: bool = True, drawn: bool = True) -> Ifs:
    torch.manual_seed(0)
    net = Ifs(IfsParams(hidden=16, velocity=velocity), objects)
    if drawn:
        nn.init.normal_(net.core.output[-1].weight)
    return net


def seen(objects: int) -> Seen:
    xy = 40 * torch.rand(1, 1, objects, 2, generator=torch_generator(0))
    moves = torch.randn(1, 4, objects, 2, generator=torch_generator(1)).cumsum(1)
    return Seen(FILM, xy + moves, torch.arange(4.0)[None])


def asked(count: int, first: int = 4) -> Tensor:
    return torch.arange(first, first + count, dtype=torch.float32)[None]


def springs(clips: int, frames: int) -> Window:
    """Two balls a clip: each on a spring to the centre, and both on a weaker one to each other."""
    xy = 14 * torch.randn(clips, 2, 2, generator=torch_generator(0))
    velocity = 2 * torch.randn(clips, 2, 2, generator=torch_generator(1))
    path = []
    for _ in range(frames):
        path.append(xy)
        velocity = velocity - 0.02 * xy - 0.01 * (xy - xy.flip(1))
        xy = xy + velocity
    whole = torch.stack(path, dim=1) + torch.tensor([WIDTH, HEIGHT]) / 2
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    film = FILM.expand(clips, -1, -1, -1, -1)
    return Window(Seen(film, whole[:, :4], times[:, :4]), times[:, 4:], whole[:, 4:], 80.0, whole)


@pytest.mark.parametrize("velocity", [True, False])
def test_an_untrained_net_goes_on_as_it_last_went(velocity):
    known = seen(objects=2)
    found = ifs(2, velocity, drawn=False)(known, asked(30)).mean
    last = known.xy[:, -1:]
    expected = last + torch.arange(1.0, 31.0).reshape(1, -1, 1, 1) * (last - known.xy[:, -2:-1])
    torch.testing.assert_close(found, expected, rtol=0, atol=1e-3)  # px


@pytest.mark.parametrize("order", [[1, 0, 2], [2, 0, 1]])
def test_permuting_objects_permutes_the_forecast(order):
    net, known = ifs(3), seen(objects=3)
    shuffled = Seen(known.frames, known.xy[:, :, order], known.times)
    expected = net(known, asked(20)).mean[:, :, order]
    torch.testing.assert_close(net(shuffled, asked(20)).mean, expected, rtol=0, atol=1e-3)  # px


def test_the_forecast_goes_on_from_forecast_positions_as_from_seen_ones():
    """The state is four positions and nothing else."""
    net, known = ifs(2), seen(objects=2)
    path = net(known, asked(12)).mean
    later = Seen(FILM, path[:, 4:8], torch.arange(8.0, 12.0)[None])
    torch.testing.assert_close(net(later, asked(4, first=12)).mean, path[:, 8:], rtol=0, atol=1e-3)  # px


def test_film_is_not_looked_at():
    net, known = ifs(2), seen(objects=2)
    other = Seen(torch.rand(FILM.shape, generator=torch_generator(2)), known.xy, known.times)
    assert torch.equal(net(other, asked(9)).mean, net(known, asked(9)).mean)


def test_another_object_changes_the_forecast_of_the_first_and_a_lone_one_has_no_relations():
    net, known = ifs(2), seen(objects=2)
    moved = Seen(FILM, known.xy + torch.tensor([[0.0, 0.0], [5.0, 0.0]]), known.times)
    change = net(moved, asked(5)).mean[:, :, 0] - net(known, asked(5)).mean[:, :, 0]
    assert change.abs().max() > 1e-3  # px
    lone = ifs(1)
    for weights in lone.core.relation.parameters():
        nn.init.constant_(weights, torch.nan)
    assert lone(seen(objects=1), asked(5)).mean.isfinite().all()


@pytest.mark.parametrize("velocity", [True, False])
def test_one_batch_is_learned_thirty_fold(velocity):
    window = springs(clips=4, frames=12)
    net = ifs(2, velocity, drawn=False)
    losses = losses_by_learning(net, lambda step: window, 150, rate=2e-2, clip_norm=1.0)
    assert losses[-1] < losses[0] / 30


def test_a_law_that_runs_away_stays_finite():
    net = ifs(1)
    nn.init.constant_(net.core.output[-1].bias, 1e6)
    still = torch.zeros(1, 84, 1, 2)
    loss, _ = net.loss(Window(seen(objects=1), asked(80), still[:, 4:], 80.0, still), torch_generator(0))
    loss.backward()
    assert loss.isfinite()
    assert all(each.grad is None or each.grad.isfinite().all() for each in net.parameters())
