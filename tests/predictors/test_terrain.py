"""Facts about the forecaster that reads its law of motion from a map."""

from dataclasses import replace

import pytest
import torch
from springs import losses_by_learning

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Seen, Window
from physpipe.predictors.kinematics import odd
from physpipe.predictors.terrain import Terrain
from physpipe.predictors.terrain_law import Motion, Scene
from physpipe.predictors.terrain_params import TerrainParams

HEIGHT, WIDTH = 40, 48
SMALL = TerrainParams(
    channels=16,
    hidden=32,
    code=2,
    matched_steps=0,
    matched_weight_s2=0,
    stretches=1,
    smoothing_s=0.06,
    spread_rounds=40,
    symmetric=True,
)


def springs(clips: int, frames: int, objects: int = 1) -> Window:
    """Balls on springs to the frame's centre; the same grey gradient for film."""
    generator = torch_generator(0)
    amplitude = 8 * torch.randn(clips, 1, objects, 2, generator=generator)
    phase = 6 * torch.rand(clips, 1, objects, 2, generator=generator)
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    xy = torch.tensor([WIDTH, HEIGHT]) / 2 + amplitude * torch.cos(0.2 * times[..., None, None] + phase)
    film = torch.linspace(0, 1, WIDTH).expand(clips, 4, 3, HEIGHT, WIDTH)
    return Window(Seen(film, xy[:, :4], times[:, :4]), times[:, 4:], xy[:, 4:], 80.0, xy)


def terrain(objects: int = 1, drawn: float = 0.0, **changed: object) -> Terrain:
    torch.manual_seed(0)
    made = Terrain(SMALL.model_copy(update=changed), objects)
    with torch.no_grad():
        for weights in made.parameters():
            weights.add_(drawn * torch.randn(weights.shape))
    return made


def flat(objects: int) -> Scene:
    """Ground that says nothing, on a frame that is wider than high."""
    ground, whole = torch.zeros(1, 16, 5, 6), torch.zeros(1, 16)
    return Scene(ground, whole, torch.zeros(1, objects, SMALL.code), torch.tensor([2.0, 1.7]))


def test_an_untrained_net_goes_straight_on():
    window = springs(clips=3, frames=8)
    steady = torch.tensor([2.0, -1.0]) * torch.arange(8.0)[:, None, None] + torch.tensor([20.0, 30.0])
    steady = steady.expand(3, -1, -1, -1)
    seen = Seen(window.seen.frames, steady[:, :4], window.seen.times)
    torch.testing.assert_close(terrain()(seen, window.asked_times).mean, steady[:, 4:], rtol=0, atol=1e-3)  # px


def test_one_batch_is_learned_tenfold():
    window = springs(clips=4, frames=16)
    net = terrain()
    losses = losses_by_learning(net, lambda step: window, 300, rate=3e-3)
    assert losses[-1] < losses[0] / 10


def test_permuted_objects_have_the_permuted_forecast():
    window, net = springs(clips=2, frames=12, objects=3), terrain(objects=3, drawn=0.05).eval()
    order = [2, 0, 1]
    there = net(Seen(window.seen.frames, window.seen.xy[:, :, order], window.seen.times), window.asked_times)
    here = net(window.seen, window.asked_times)
    torch.testing.assert_close(there.mean, here.mean[:, :, order], rtol=0, atol=1e-3)  # px


def test_an_object_is_pushed_by_another_only_where_there_is_one():
    window = springs(clips=2, frames=12, objects=2)
    net = terrain(objects=2, drawn=0.05).eval()
    moved = window.seen.xy.clone()
    moved[:, :, 1] += 3
    apart = (
        net(Seen(window.seen.frames, moved, window.seen.times), window.asked_times).mean
        - net(window.seen, window.asked_times).mean
    )
    assert apart[:, :, 0].abs().max() > 1e-2  # px
    assert terrain(objects=1).law.contact is None


def test_two_balls_on_flat_ground_roll_meet_slide_and_roll_on_as_mechanics_has_it():
    """Head on, one at rest: equal masses, restitution 0.8, and of what each gained 2/7 goes back while it slides."""
    law = terrain(objects=2).law
    assert law.contact is not None
    law.contact.spin.data = torch.tensor(20.0)  # spins as before
    law.sliding.grip.data = torch.tensor(0.004).log()
    reach, fast = law.contact.reach.exp().item(), 0.05
    scene = flat(objects=2)
    place = torch.tensor([[[[-reach - 1.5 * fast, 0.0], [0.0, 0.0]]]])
    for each in law.slope.parameters():
        each.data.zero_()
    now, paths = Motion.rolling(place, torch.tensor([[[[fast, 0.0], [0.0, 0.0]]]])), []
    with torch.no_grad():
        for _ in range(30):
            now = law(scene, now)
            paths.append(now)
    torch.testing.assert_close(paths[0].velocity[0, 0, :, 0], torch.tensor([fast, 0.0]))
    hit = torch.tensor([0.1, 0.9]) * fast  # Newton's law of impact
    slower = torch.tensor([0.9, -0.9]) * fast * 2 / 7
    torch.testing.assert_close(paths[-1].velocity[0, 0, :, 0], hit + slower, rtol=0, atol=2e-4)
    friction = torch.tensor([0.004, -0.004])
    torch.testing.assert_close(paths[1].velocity[0, 0, :, 0], hit + friction, rtol=0, atol=2e-4)
    moved = torch.tensor([-reach - 0.5 * fast, 0.0]) + 0.5 * (torch.tensor([fast, 0.0]) + hit) + friction
    torch.testing.assert_close(paths[1].place[0, 0, :, 0], moved, rtol=0, atol=3e-4)


def test_what_a_meeting_smears_over_a_smoothed_track_teaches_the_ground_nothing():
    """Two balls that meet at frame 10."""
    ahead = torch.linspace(-0.5, 0.5, 21).abs() + 0.05
    track = torch.stack([torch.stack([ahead, 0 * ahead], -1), torch.stack([-ahead, 0 * ahead], -1)], dim=1)[None]
    law = terrain(objects=2).law
    scene = flat(objects=2)
    for _ in range(600):
        law.see(scene, track)
    free = law.untouched(scene, track, width=5)[0, :, 0]
    assert free.tolist() == [float(10 not in range(at, at + 5)) for at in range(17)]


def mismatch(net: Terrain, window: Window) -> float:
    """Pixels a frame squared."""
    return net.loss(window, torch_generator(0))[1]["train_change_px"]


def with_cushions(at: float) -> Terrain:
    """Halves of the frame's longer side from its middle."""
    net = terrain()
    net.law.cushions.share.fill_(1.0)
    net.law.cushions.reach.data = torch.tensor(at).log()
    return net


def test_a_cushion_turns_what_runs_into_it_and_friction_slows_what_slides_from_there_on():
    law, fast = with_cushions(at=0.6).law, 0.05
    law.cushions.spin.data = torch.tensor(20.0)  # spins as before
    law.sliding.grip.data = torch.tensor(0.004).log()
    for each in law.slope.parameters():
        each.data.zero_()
    now, velocities = Motion.rolling(torch.tensor([[[[0.57, 0.0]]]]), torch.tensor([[[[fast, 0.01]]]])), []
    with torch.no_grad():
        for _ in range(30):
            now = law(flat(objects=1), now)
            velocities.append(now.velocity[0, 0, 0])
    after = -0.8 * fast  # Newton's law of impact
    torch.testing.assert_close(velocities[0], torch.tensor([after + 0.004, 0.01]), rtol=0, atol=2e-4)
    torch.testing.assert_close(velocities[-1], torch.tensor([after + 1.8 * fast * 2 / 7, 0.01]), rtol=0, atol=2e-4)


def test_a_ball_seen_while_a_cushion_turns_it_is_forecast_to_go_on_as_fast_as_it_left():
    net, half, fast = with_cushions(at=20 / 24), WIDTH / 2, 3.0  # px
    net.law.cushions.bounce.data = torch.tensor(0.8).logit()
    net.law.cushions.spin.data = torch.tensor(-20.0)  # nothing slides
    centre = torch.tensor([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
    out = torch.tensor([20 - 0.4 * fast - fast, 20 - 0.4 * fast, 20 - 0.8 * 0.6 * fast, 20 - 0.8 * 1.6 * fast])
    places = centre + torch.stack([out, torch.zeros(4)], dim=-1)
    times = torch.arange(8.0)[None]
    film = torch.full((1, 4, 3, HEIGHT, WIDTH), 0.5)
    path = net(Seen(film, places[None, :, None], times[:, :4]), times[:, 4:]).mean[0, :, 0]
    expected = places[-1] - torch.tensor([0.8 * fast, 0.0]) * torch.arange(1.0, 5)[:, None]
    torch.testing.assert_close(path, expected, rtol=0, atol=0.02 * half)


def test_where_a_cushion_turns_it_the_law_is_not_matched_to_the_track():
    out = (0.05 * (torch.arange(21) - 10.0)).abs()
    track = torch.stack([0.6 - out, 0 * out], dim=-1)[None, :, None]
    free = with_cushions(at=0.6).law.untouched(flat(objects=1), track, width=5)[0, :, 0]
    assert free.tolist() == [float(10 not in range(at, at + 5)) for at in range(17)]


def test_where_objects_meet_the_law_is_not_matched_to_the_tracks():
    window = springs(clips=4, frames=24, objects=2)
    bent = window.track.clone()
    bent[:, 12] += 3  # px, which no law explains
    net = terrain(objects=2, matched_steps=10, smoothing_s=0.06)
    assert net.law.contact is not None
    net.law.contact.reach.data = torch.tensor(10.0).log()  # all is one meeting
    changes = [mismatch(net, replace(window, track=each)) for each in (window.track, bent)]
    assert changes == [0, 0]
    net.law.contact.reach.data = torch.tensor(0.001).log()
    changes = [mismatch(net, replace(window, track=each)) for each in (window.track, bent)]
    assert 0 < changes[0] < changes[1]


def test_the_law_is_matched_to_the_tracks_before_forecasts_are_trained():
    window = springs(clips=4, frames=24)
    net = terrain(matched_steps=300, smoothing_s=0.09)
    before = mismatch(terrain(matched_steps=300, smoothing_s=0.09), window)
    losses_by_learning(net, lambda step: window, 300, rate=3e-3)
    assert mismatch(net, window) < before / 10
    off = (net.train()(window.seen, window.asked_times).mean - window.target).norm(dim=-1)
    assert off[:, -1].mean() < 1.5  # px after 20 frames; straight on it is 15
    _, parts = net.loss(window, torch_generator(0))
    assert parts["train_last_px"] == pytest.approx(off[:, -1].mean().item(), abs=1e-2)


def test_tracks_are_smoothed_over_the_same_time_at_any_rate_but_over_no_fewer_frames_than_a_cubic_takes():
    assert [odd(0.11 * rate) for rate in (240, 80, 30, 10)] == [27, 9, 5, 5]
    assert odd(7.9) == 7
    assert odd(8.1) == 9


def test_the_same_motion_filmed_at_another_rate_is_matched_with_the_same_weight():
    window = springs(clips=4, frames=24)
    net = terrain(matched_weight_s2=0.01, smoothing_s=0.02)  # over the same frames at both rates
    at_80, at_160 = (net.loss(replace(window, frames_per_s=rate), torch_generator(0)) for rate in (80.0, 160.0))
    forecasts = at_80[0].item() - 0.01 * 80**2 * at_80[1]["train_change_px"]
    assert at_160[0].item() - 0.01 * 160**2 * at_160[1]["train_change_px"] == pytest.approx(forecasts, rel=1e-4)


def test_a_shaken_camera_changes_no_forecast_of_the_scene_before_it():
    """Film of a texture and a ball that stands still, both shaken alike: the ball is forecast to stay."""
    generator = torch_generator(3)
    coarse = torch.rand(1, 3, 12, 14, generator=generator)
    texture = torch.nn.functional.interpolate(coarse, (HEIGHT + 2, WIDTH + 2), mode="bicubic", align_corners=True)
    shifts = torch.tensor([[0.6, -0.3], [0.4, -0.2], [0.2, -0.1], [0.0, 0.0]])
    film = torch.stack([shifted(texture[0], *shift.tolist()) for shift in shifts])[None]
    xy = (torch.tensor([24.0, 20.0]) + shifts)[None, :, None]
    times = torch.arange(12.0)[None]
    path = terrain()(Seen(film, xy, times[:, :4]), times[:, 4:]).mean
    assert (path - torch.tensor([24.0, 20.0])).abs().max() < 0.4  # px; the plain slope ends 1.6 px away
    assert (path - torch.tensor([24.0, 20.0]))[:, 0].abs().max() < 0.1
    steadied = Seen(film, xy - shifts[None, :, None], times[:, :4], steady=True)
    torch.testing.assert_close(terrain()(steadied, times[:, 4:]).mean, path, rtol=0, atol=0.4)
    assert (terrain()(replace(steadied, xy=xy), times[:, 4:]).mean - path)[:, -1].abs().max() > 1  # taken as they are


def shifted(picture: torch.Tensor, x: float, y: float) -> torch.Tensor:
    """(3, H, W) of (3, H + 2, W + 2), its content moved by less than a pixel along x and y."""
    rows = torch.linspace(-1, 1, picture.shape[1])[1:-1] - y * 2 / (picture.shape[1] - 1)
    columns = torch.linspace(-1, 1, picture.shape[2])[1:-1] - x * 2 / (picture.shape[2] - 1)
    grid = torch.stack([columns.expand(len(rows), -1), rows[:, None].expand(-1, len(columns))], dim=-1)[None]
    return torch.nn.functional.grid_sample(picture[None], grid, mode="bicubic", align_corners=True)[0]
