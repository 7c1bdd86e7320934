import pytest
import torch
from springs import STATE, distances_by_learning, springs

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.tensor_state import TensorStateParams


def dispnet(objects: int = 1, **changed: object) -> DispNet:
    torch.manual_seed(0)
    return DispNet(TensorStateParams(**{**STATE, **changed}), objects)


def test_an_untrained_net_goes_straight_on():
    window = springs(clips=3, frames=8)
    steady = torch.tensor([2.0, -1.0]) * torch.arange(8.0)[:, None, None] + torch.tensor([20.0, 30.0])
    steady = steady.expand(3, -1, -1, -1)
    seen = Seen(window.seen.frames, steady[:, :4], window.seen.times)
    torch.testing.assert_close(dispnet()(seen, window.asked_times).mean, steady[:, 4:], rtol=0, atol=1e-3)  # px


@pytest.mark.parametrize("follow", [True, False])
def test_one_batch_is_learned_fifty_fold(follow):
    before, after = distances_by_learning(dispnet(follow=follow), springs(clips=4, frames=12), steps=250)
    assert after < before / 50


def test_a_law_that_runs_away_stays_finite_and_can_still_be_learned_from():
    """The square of a displacement adds to the next one: without a bound 36 steps of this law overflow."""
    window = springs(clips=2, frames=40)
    net = dispnet(symmetric=False)
    torch.nn.init.constant_(net.law[-1].bias, 30.0)
    loss, _ = net.loss(window, torch_generator(0))
    loss.backward()
    assert torch.isfinite(loss)
    assert all(torch.isfinite(each.grad).all() for each in net.parameters() if each.grad is not None)
