import torch
from springs import STATE, distances_by_learning, springs

from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.posnet import PosNet
from physpipe.predictors.tensor_state import TensorState, TensorStateParams


def posnet(**changed: object) -> PosNet:
    torch.manual_seed(0)
    return PosNet(TensorStateParams(**{**STATE, **changed}), objects=1)


def drawn(net: TensorState) -> TensorState:
    """With a law of motion that is not zero, the same for equal nets."""
    torch.manual_seed(1)
    torch.nn.init.normal_(net.law[-1].weight)
    return net


def test_one_batch_is_learned_twenty_fold():
    before, after = distances_by_learning(posnet(follow=False), springs(clips=4, frames=12), steps=250)
    assert after < before / 20


def test_it_does_what_dispnet_does_only_when_it_follows():
    window = springs(clips=2, frames=10)
    for follow in (True, False):
        params = TensorStateParams(**{**STATE, "follow": follow})
        torch.manual_seed(0)
        other = drawn(DispNet(params, objects=1))
        apart = drawn(posnet(follow=follow))(window.seen, window.asked_times).mean
        apart = apart - other(window.seen, window.asked_times).mean
        assert apart[:, 0].abs().max() < 1e-3  # px, one frame after what was seen
        assert (apart.abs().max() < 1e-3) == follow


def test_a_steady_change_leads_it_where_it_leads_dispnet():
    """Without `follow` it adds nothing up, so it must know how far a steady change has led after any time."""
    window = springs(clips=2, frames=12)
    found = []
    for kind in (PosNet, DispNet):
        torch.manual_seed(0)
        net = kind(TensorStateParams(**{**STATE, "follow": False, "symmetric": False}), objects=1)
        with torch.no_grad():
            net.law[-1].bias[[0, 6]] = torch.tensor([0.3, -0.2])  # constant terms along x and y
        found.append(net(window.seen, window.asked_times).mean)
    torch.testing.assert_close(found[0], found[1], rtol=0, atol=1e-3)  # px


def test_forecasts_stay_in_the_frame():
    window = springs(clips=1, frames=80)
    found = drawn(posnet(follow=False))(window.seen, window.asked_times).mean
    assert (found - torch.tensor([31.5, 23.5])).abs().max() <= 32 + 1e-3  # px: half of the longer side
