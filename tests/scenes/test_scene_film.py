import io

import av
import cv2
import numpy as np
import pytest

from physpipe.scenes.film import Camera, encode, smooth_drift
from physpipe.scenes.world_params import WorldParams


@pytest.mark.parametrize("seed", range(5))
def test_drift_is_bounded_and_slow(seed: int) -> None:
    curve = smooth_drift(480, 240, 3, np.random.default_rng(seed))
    assert np.abs(curve).max() <= 1
    assert np.abs(np.diff(curve)).max() <= 2 * np.pi * 3 / 240  # the steepest 3-Hz wave of height 1


@pytest.mark.parametrize("seed", range(5))
def test_wobble_and_light_stay_within_their_bounds(world: WorldParams, seed: int) -> None:
    camera = Camera(world.camera, 240, np.random.default_rng(seed))
    assert np.hypot(*camera.wobble.T).max() <= world.camera.wobble_px
    assert np.abs(camera.gain - 1).max() <= world.camera.drift
    assert camera.wobble.std() > 0.05 * world.camera.wobble_px


def test_projection_scales_and_follows_the_wobble(world: WorldParams) -> None:
    camera = Camera(world.camera, 5, np.random.default_rng(0))
    metres = np.array([0.1, -0.05, 0.3])
    xy = camera.project(np.broadcast_to(metres, (5, 1, 3)))
    expected = camera.centre + world.camera.pixels_per_metre * metres[:2] + camera.wobble
    np.testing.assert_allclose(xy[:, 0], expected, atol=1e-9)


def test_noise_has_the_asked_strength(world: WorldParams) -> None:
    camera = Camera(world.camera.model_copy(update={"drift": 0}), 8, np.random.default_rng(0))
    grey = np.full((world.camera.height, world.camera.width, 3), 128, np.float32)
    frames = np.stack(list(camera.expose([grey] * 8))).astype(float)
    assert frames.std() == pytest.approx(world.camera.noise, rel=0.05)
    assert frames.mean() == pytest.approx(128, abs=0.2)
    assert not np.array_equal(frames[0], frames[1])


def test_video_keeps_count_rate_size_and_picture(world: WorldParams) -> None:
    camera = world.camera.model_copy(update={"crf": 1})
    coarse = np.random.default_rng(0).integers(60, 200, (6, 14, 16, 3)).astype(np.uint8)
    frames = [cv2.resize(each, (camera.width, camera.height), interpolation=cv2.INTER_CUBIC) for each in coarse]
    with av.open(io.BytesIO(encode(frames, camera))) as container:
        stream = container.streams.video[0]
        shown = list(container.decode(stream))
        assert stream.average_rate == camera.fps
    assert [frame.pts * frame.time_base * camera.fps for frame in shown] == list(range(6))
    decoded = np.stack([frame.to_ndarray(format="rgb24") for frame in shown]).astype(float)
    assert decoded.shape == (6, camera.height, camera.width, 3)
    assert np.abs(decoded.mean(axis=3) - np.stack(frames).mean(axis=3)).mean() < 4  # grey levels; colour is halved
