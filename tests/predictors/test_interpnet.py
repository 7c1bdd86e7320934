import pytest
import torch
from springs import HEIGHT, STATE, WIDTH, distances_by_learning, losses_by_learning, spots, springs

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.interpnet import InterpNet, InterpNetParams

ROOM = torch.tensor([WIDTH - 16.0, HEIGHT - 16.0])


def interpnet(first_state: float = 1.0, **changed: object) -> InterpNet:
    torch.manual_seed(0)
    return InterpNet(InterpNetParams(**{**STATE, "first_state": first_state, **changed}), objects=1)


def test_one_batch_is_learned_twenty_fold():
    window = springs(clips=4, frames=12, sees_end=True)
    before, after = distances_by_learning(interpnet(), window, steps=250)
    assert after < before / 20


def test_the_end_that_is_seen_reaches_every_position_between():
    window, net = springs(clips=1, frames=12, sees_end=True), interpnet()
    torch.nn.init.normal_(net.law[-1].weight)
    before = net(window.seen, window.asked_times).mean
    frames = torch.cat([window.seen.frames[:, :4], window.seen.frames[:, 4:].flip(-1)], 1)
    changed = net(Seen(frames, window.seen.xy, window.seen.times), window.asked_times).mean
    assert (changed - before).abs().amax((0, 2, 3)).min() > 1e-3  # px


def test_a_forecast_depends_on_how_far_off_the_end_is():
    window, net = springs(clips=1, frames=12, sees_end=True), interpnet()
    torch.nn.init.normal_(net.law[-1].weight)
    later = window.seen.times.clone()
    later[:, -1] += 9
    asked = window.asked_times[:, :3]
    before = net(window.seen, asked).mean
    assert (net(Seen(window.seen.frames, window.seen.xy, later), asked).mean - before).abs().max() > 1e-3  # px


def test_the_loss_adds_what_the_first_state_tells_of_the_seen_positions_and_the_end():
    window = springs(clips=3, frames=10, sees_end=True)
    losses = []
    for first_state in (0.0, 1.0, 3.0):
        loss, parts = interpnet(first_state).loss(window, torch_generator(0))
        losses.append(loss.item())
    missed = interpnet().train()(window.seen, window.asked_times).mean - window.target
    assert losses[0] == pytest.approx(missed.norm(dim=-1).mean().item(), abs=1e-3)
    assert losses[2] - losses[0] == pytest.approx(3 * (losses[1] - losses[0]), rel=1e-4)
    assert parts["train_end_px"] > 1


def leaving(clips: int, generator: torch.Generator) -> Window:
    """Balls at rest that leave in the fourth frame for anywhere, at a steady pace: only the last frame tells where."""
    start, end = (torch.tensor([8.0, 8.0]) + torch.rand(clips, 1, 1, 2, generator=generator) * ROOM for _ in range(2))
    times = torch.arange(8.0).expand(clips, -1)
    xy = start + (end - start) * ((times - 3) / 4).clamp(min=0)[:, :, None, None]
    seen = [0, 1, 2, 3, 7]
    return Window(Seen(spots(xy[:, seen, 0]), xy[:, :4], times[:, seen]), times[:, 4:], xy[:, 4:], 80.0, xy)


def test_the_way_to_an_end_that_only_the_last_frame_tells_is_learned_and_not_by_heart():
    net = interpnet(symmetric=False)
    losses_by_learning(net, lambda step: leaving(16, torch_generator(0, step)), 200, rate=1e-2)
    fresh = leaving(64, torch_generator(1))
    with torch.no_grad():
        missed = (net(fresh.seen, fresh.asked_times).mean - fresh.target).norm(dim=-1)
    still = (fresh.seen.xy[:, -1:] - fresh.target).norm(dim=-1)
    assert (missed.mean(0) < still.mean(0) / 3).all()


def test_a_law_that_runs_away_stays_in_the_frame_and_can_still_be_learned_from():
    window, net = springs(clips=2, frames=40, sees_end=True), interpnet(symmetric=False)
    torch.nn.init.constant_(net.law[-1].bias, 30.0)
    found = net(window.seen, window.asked_times).mean
    assert (found - torch.tensor([WIDTH - 1, HEIGHT - 1]) / 2).abs().max() <= WIDTH / 2 + 1e-3  # px
    net.loss(window, torch_generator(0))[0].backward()
    assert all(each.grad.isfinite().all() for each in net.parameters() if each.grad is not None)
