import pytest
import torch
from springs import losses_by_learning
from torch import Tensor, nn

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.vin import Vin, VinParams

HEIGHT, WIDTH = 64, 128
SMALL = VinParams(channels=8, code=12, hidden=16, seen_weight=0.5, velocity_weight=2.0)
COLOURS = torch.eye(3)[:2]


def vin(objects: int = 2, params: VinParams = SMALL) -> Vin:
    torch.manual_seed(0)
    return Vin(params, objects)


def passing(clips: int, frames: int) -> Window:
    """A red and a green ball a clip that go straight; the first six frames are seen."""
    start = torch.tensor([WIDTH, HEIGHT]) * (0.25 + 0.5 * torch.rand(clips, 1, 2, 2, generator=torch_generator(0)))
    velocity = 2 * torch.randn(clips, 1, 2, 2, generator=torch_generator(1))
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    xy = start + velocity * times[:, :, None, None]
    return Window(Seen(film(xy[:, :6]), xy[:, :6], times[:, :6]), times[:, 6:], xy[:, 6:], 80.0, xy)


def film(xy: Tensor) -> Tensor:
    """(B, T, 3, H, W) with a spot of its colour at each of `xy` (B, T, 2, 2) px."""
    x, y = torch.arange(WIDTH), torch.arange(HEIGHT)[:, None]
    spots = torch.exp(-((x - xy[..., 0, None, None]) ** 2 + (y - xy[..., 1, None, None]) ** 2) / 50)
    return torch.einsum("btkhw,kc->btchw", spots, COLOURS)


def test_film_alone_tells_where_objects_are_so_slots_keep_their_order():
    window, net = passing(clips=2, frames=10), vin()
    before = net(window.seen, window.asked_times).mean
    exchanged = Seen(window.seen.frames, window.seen.xy.flip(2) + 9, window.seen.times)
    assert torch.equal(net(exchanged, window.asked_times).mean, before)
    other = Seen(window.seen.frames.flip(-1), window.seen.xy, window.seen.times)
    assert (net(other, window.asked_times).mean - before).abs().max() > 1e-3  # px


def test_past_the_encoder_all_slots_are_alike():
    """Permuting what the encoder gives for each object permutes the forecast."""
    window, net, order = passing(clips=2, frames=12), vin(objects=3), [2, 0, 1]
    before = net(window.seen, window.asked_times).mean
    slots = net.encode[-1]
    with torch.no_grad():
        for weights in (slots.weight, slots.bias):
            weights.copy_(weights.unflatten(0, (3, SMALL.code))[order].flatten(0, 1))
    torch.testing.assert_close(net(window.seen, window.asked_times).mean, before[:, :, order], rtol=0, atol=1e-3)


def test_frames_are_averaged_over_the_areas_of_32_by_32_pixels():
    """Stripes finer than those, 2 px high and 4 px wide here, are not seen; what is as wide as they are is."""
    window, net = passing(clips=1, frames=8), vin()
    fine = 0.2 * (-1.0) ** torch.arange(WIDTH)
    coarse = 0.2 * (-1.0) ** (torch.arange(WIDTH) // 4)
    before = net(window.seen, window.asked_times).mean
    changes = []
    for stripes in (fine, coarse):
        striped = Seen(window.seen.frames + stripes, window.seen.xy, window.seen.times)
        changes.append((net(striped, window.asked_times).mean - before).abs().max().item())
    assert changes[0] < 1e-3  # px
    assert changes[1] > 1e-2


def test_every_seen_frame_reaches_the_forecast():
    window, net = passing(clips=1, frames=8), vin()
    before = net(window.seen, window.asked_times).mean
    for frame in range(6):
        frames = window.seen.frames.clone()
        frames[:, frame] = 0.5
        changed = net(Seen(frames, window.seen.xy, window.seen.times), window.asked_times).mean
        assert (changed - before).abs().max() > 1e-4  # px


def test_a_lone_object_has_no_relations():
    window, net = passing(clips=1, frames=9), vin(objects=1)
    for core in net.cores:
        for weights in core.relation.parameters():
            nn.init.constant_(weights, torch.nan)
    assert net(window.seen, window.asked_times).mean.isfinite().all()


def test_the_loss_by_hand_of_a_net_that_says_rest_at_the_centre():
    window, net = passing(clips=3, frames=12), vin()
    nn.init.zeros_(net.decode.weight)
    nn.init.zeros_(net.decode.bias)
    whole = torch.cat([window.seen.xy, window.target], dim=1)
    from_centre = (whole - torch.tensor([63.5, 31.5])).norm(dim=-1)
    speed = (whole[:, 1] - whole[:, 0]).norm(dim=-1)
    loss, parts = net.loss(window, torch_generator(0))
    expected = from_centre[:, 6:].mean() + 0.5 * from_centre[:, 2:6].mean() + 2.0 * speed.mean()
    assert loss.item() == pytest.approx(expected.item(), abs=1e-3)  # px
    assert parts["train_last_px"] == pytest.approx(from_centre[:, -1].mean().item(), abs=1e-3)
    assert parts["train_seen_px"] == pytest.approx(from_centre[:, 2:6].mean().item(), abs=1e-3)


def test_one_batch_is_learned_twenty_fold():
    window = passing(clips=2, frames=9)
    net = vin(params=SMALL.model_copy(update={"velocity_weight": 0.0}))
    losses = losses_by_learning(net, lambda step: window, 100, rate=5e-3, clip_norm=1.0)
    assert losses[-1] < losses[0] / 20


def test_codes_that_run_away_stay_finite():
    window, net = passing(clips=1, frames=8), vin()
    for each in (net.cores[0].output[-1], net.aggregate[-1]):
        nn.init.constant_(each.weight, 100.0)
    assert net(window.seen, torch.arange(6.0, 106.0)[None]).mean.isfinite().all()
