import pytest
import torch
from torch import Tensor

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.dispnet import DispNet, DispNetParams

HEIGHT, WIDTH = 48, 64
SMALL = DispNetParams(stem=8, channels=16, hidden=16, follow=True, symmetric=True)


def springs(clips: int, frames: int) -> Window:
    """One ball a clip on a spring to the frame's centre, as a red spot; the first four frames are seen."""
    generator = torch_generator(0)
    amplitude = 12 * torch.randn(clips, 1, 2, generator=generator)
    phase = 6 * torch.rand(clips, 1, 2, generator=generator)
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    xy = torch.tensor([WIDTH, HEIGHT]) / 2 + amplitude * torch.cos(0.25 * times[..., None] + phase)
    xy = xy.unsqueeze(2)
    return Window(Seen(spots(xy[:, :4, 0]), xy[:, :4], times[:, :4]), times[:, 4:], xy[:, 4:])


def spots(xy: Tensor) -> Tensor:
    """(B, T, 3, H, W): a red spot at `xy` (B, T, 2) px."""
    x, y = torch.arange(WIDTH), torch.arange(HEIGHT)[:, None]
    red = torch.exp(-((x - xy[..., 0, None, None]) ** 2 + (y - xy[..., 1, None, None]) ** 2) / 18)
    return torch.stack([red, torch.zeros_like(red), torch.zeros_like(red)], dim=2)


def dispnet(params: DispNetParams = SMALL, objects: int = 1) -> DispNet:
    torch.manual_seed(0)
    return DispNet(params, objects)


def test_an_untrained_net_goes_straight_on():
    window = springs(clips=3, frames=8)
    steady = torch.tensor([2.0, -1.0]) * torch.arange(8.0)[:, None, None] + torch.tensor([20.0, 30.0])
    steady = steady.expand(3, -1, -1, -1)
    seen = Seen(window.seen.frames, steady[:, :4], window.seen.times)
    torch.testing.assert_close(dispnet()(seen, window.asked_times).mean, steady[:, 4:], rtol=0, atol=1e-3)  # px


@pytest.mark.parametrize("follow", [True, False])
def test_one_batch_is_learned_fifty_fold(follow):
    window = springs(clips=4, frames=16)
    net = dispnet(SMALL.model_copy(update={"follow": follow}))
    optimiser = torch.optim.Adam(net.parameters(), lr=3e-3)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, 400)
    losses = []
    for _ in range(400):
        optimiser.zero_grad()
        loss, _parts = net.loss(window, torch_generator(0))
        loss.backward()
        optimiser.step()
        schedule.step()
        losses.append(loss.item())
    assert losses[-1] < losses[0] / 50


def test_only_a_net_that_follows_reads_the_state_where_the_ball_will_be():
    """With equal weights the two differ from the second step on, when the ball has left its last seen position."""
    window = springs(clips=2, frames=8)
    paths = []
    for follow in (True, False):
        net = dispnet(SMALL.model_copy(update={"follow": follow}))
        torch.manual_seed(1)
        torch.nn.init.normal_(net.change[-1].weight)
        paths.append(net(window.seen, window.asked_times).mean)
    torch.testing.assert_close(paths[0][:, 0], paths[1][:, 0], rtol=0, atol=1e-4)
    assert (paths[0][:, -1] - paths[1][:, -1]).abs().max() > 1e-2  # px


def test_frames_and_positions_both_reach_the_forecast():
    window = springs(clips=1, frames=8)
    net = dispnet()
    torch.nn.init.normal_(net.change[-1].weight)
    before = net(window.seen, window.asked_times).mean
    for changed in (
        Seen(window.seen.frames.flip(-1), window.seen.xy, window.seen.times),
        Seen(window.seen.frames, window.seen.xy + torch.tensor([0.5, 0.0]), window.seen.times),
    ):
        assert (net(changed, window.asked_times).mean - before).abs().max() > 1e-3  # px


def test_several_objects_on_frames_that_no_power_of_two_divides():
    net = dispnet(objects=2)
    seen = Seen(torch.rand(1, 4, 3, 50, 70), 30 * torch.rand(1, 4, 2, 2), torch.arange(4.0)[None])
    assert net(seen, torch.tensor([[4.0, 9.0]])).mean.shape == (1, 2, 2, 2)


def test_a_law_that_runs_away_stays_finite_and_can_still_be_learned_from():
    """The square of a displacement adds to the next one: without a bound 36 steps of this law overflow."""
    window = springs(clips=2, frames=40)
    net = dispnet(SMALL.model_copy(update={"symmetric": False}))
    torch.nn.init.constant_(net.change[-1].bias, 30.0)
    loss, _ = net.loss(window, torch_generator(0))
    loss.backward()
    assert torch.isfinite(loss)
    assert all(torch.isfinite(each.grad).all() for each in net.parameters() if each.grad is not None)
