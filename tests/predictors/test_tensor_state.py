"""Facts about the state that PosNet, DispNet, ProbNet and InterpNet share, seen through DispNet."""

import torch
from springs import STATE, springs

from physpipe.predictors.base import Seen
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.tensor_state import TensorStateParams


def pulled(objects: int = 1, **changed: object) -> DispNet:
    """A net whose untrained law of motion pulls somewhere."""
    torch.manual_seed(0)
    net = DispNet(TensorStateParams(**{**STATE, **changed}), objects)
    torch.manual_seed(1)
    torch.nn.init.normal_(net.law[-1].weight)
    return net


def two_balls() -> Seen:
    """On frames that no power of two divides."""
    generator = torch.Generator().manual_seed(2)
    frames = torch.rand(1, 4, 3, 50, 70, generator=generator)
    return Seen(frames, 10 + 30 * torch.rand(1, 4, 2, 2, generator=generator), torch.arange(4.0)[None])


def test_only_a_net_that_follows_reads_the_state_where_the_ball_will_be():
    """With equal weights the two differ from the second step on, when the ball has left its last seen position."""
    window = springs(clips=2, frames=8)
    paths = [pulled(follow=follow)(window.seen, window.asked_times).mean for follow in (True, False)]
    torch.testing.assert_close(paths[0][:, 0], paths[1][:, 0], rtol=0, atol=1e-4)
    assert (paths[0][:, -1] - paths[1][:, -1]).abs().max() > 1e-2  # px


def test_frames_and_positions_both_reach_the_forecast():
    window = springs(clips=1, frames=8)
    net = pulled()
    before = net(window.seen, window.asked_times).mean
    for changed in (
        Seen(window.seen.frames.flip(-1), window.seen.xy, window.seen.times),
        Seen(window.seen.frames, window.seen.xy + torch.tensor([0.5, 0.0]), window.seen.times),
    ):
        assert (net(changed, window.asked_times).mean - before).abs().max() > 1e-3  # px


def test_only_objects_that_are_alike_may_change_their_numbers():
    seen, asked = two_balls(), torch.tensor([[4.0, 9.0]])
    other = Seen(seen.frames, seen.xy.flip(2), seen.times)
    for alike in (True, False):
        net = pulled(objects=2, objects_alike=alike)
        off = (net(other, asked).mean.flip(2) - net(seen, asked).mean).abs().max()
        assert net.objects_alike == alike
        assert off < 1e-3 if alike else off > 1e-2  # px


def test_each_object_feels_the_other():
    seen, asked = two_balls(), torch.tensor([[9.0]])
    moved = seen.xy + torch.tensor([[0.0, 0.0], [5.0, 0.0]])
    net = pulled(objects=2)
    off = net(Seen(seen.frames, moved, seen.times), asked).mean - net(seen, asked).mean
    assert off[:, :, 0].abs().max() > 1e-2  # px, of the object that began where it did before


def test_one_object_is_alike_or_not_with_the_same_weights_and_forecasts():
    window = springs(clips=2, frames=12)
    alike, apart = pulled(objects_alike=True), pulled(objects_alike=False)
    assert [each.shape for each in alike.parameters()] == [each.shape for each in apart.parameters()]
    expected = apart(window.seen, window.asked_times).mean
    torch.testing.assert_close(alike(window.seen, window.asked_times).mean, expected, rtol=0, atol=1e-3)  # px
