"""What moves is found where it is, as large and as fast as it is, and as often."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from physpipe.probing.findings import Finding, look

RADIUS_PX = 5.0
Frames = NDArray[np.uint8]


def found(path: Path) -> Finding:
    return look(path, path.parent, None)


def swing(frames: int, objects: int = 1) -> NDArray[np.float64]:
    """(T, K, 2) pixels: objects side by side swing up and down, 1 px a frame at most."""
    phase = 2 * np.pi * np.arange(frames)[:, None] / 80 + np.arange(objects)
    x = 30 + 30 * np.arange(objects) + 8 * np.sin(phase / 2)
    return np.stack([x, 30 + 12 * np.sin(phase)], axis=-1)


@pytest.mark.parametrize("objects", [1, 2])
def test_balls_are_counted_and_measured(roll: Callable[..., Path], objects: int) -> None:
    xy = swing(100, objects)
    finding = found(roll(xy))
    assert finding.movers is not None
    assert finding.movers.number == objects
    assert finding.diameter_px == pytest.approx(2 * RADIUS_PX, rel=0.2)
    edges = [*(xy.min((0, 1)) - RADIUS_PX), *(xy.max((0, 1)) + RADIUS_PX)]
    np.testing.assert_allclose(finding.box, edges, atol=2.5)  # pixels
    true = np.quantile(np.linalg.norm(np.diff(xy, axis=0), axis=-1), 0.95)
    assert finding.speed_px == pytest.approx(true, abs=0.35)  # pixels a frame
    assert finding.moving > 0.8
    assert finding.disturbed == 0


def test_positions_are_the_middles(roll: Callable[..., Path]) -> None:
    xy = swing(100)
    finding = found(roll(xy))
    for pair, spots in zip(finding.film.pairs, finding.movers.objects, strict=True):
        true = xy[round(pair.place * 100), 0]
        assert [(spot.x, spot.y) for spot in spots] == [pytest.approx(true, abs=1.0)]


def test_noise_flicker_and_a_shaking_camera_move_nothing(roll: Callable[..., Path]) -> None:
    def spoil(frames: Frames) -> Frames:
        rng = np.random.default_rng(0)
        shaken = [np.roll(each, (t % 3 - 1, t % 2), axis=(0, 1)) for t, each in enumerate(frames)]
        light = 1 + 0.1 * np.sin(np.arange(len(frames)))[:, None, None, None]
        return (shaken * light + rng.normal(0, 3, frames.shape)).clip(0, 255).astype(np.uint8)

    finding = found(roll(swing(100), spoil))
    assert finding.movers is not None
    assert finding.movers.number == 1
    assert finding.diameter_px == pytest.approx(2 * RADIUS_PX, rel=0.3)
    assert found(roll(np.full((100, 1, 2), 30.0), spoil, "film/still.mkv")).movers is None


def test_a_long_rest_hides_nothing(roll: Callable[..., Path]) -> None:
    xy = np.concatenate([np.repeat(swing(1), 150, axis=0), swing(60)])
    finding = found(roll(xy))
    assert finding.movers is not None
    assert finding.movers.number == 1
    first, last = finding.span
    assert first == pytest.approx(150 / 210, abs=0.06)
    assert last > 0.9
    assert finding.moving == pytest.approx(60 / 210, abs=0.1)


def test_a_rod_is_no_part_of_its_ball(roll: Callable[..., Path]) -> None:
    xy = swing(100)

    def hang(frames: Frames) -> Frames:
        hung = frames.copy()
        for frame, (x, y) in zip(hung, xy[:, 0], strict=True):
            cv2.line(frame, (45, 2), (round(x), round(y)), (60, 60, 60), 1)
        return hung

    finding = found(roll(xy, hang))
    assert finding.diameter_px == pytest.approx(2 * RADIUS_PX, rel=0.25)
    assert finding.movers is not None
    assert finding.movers.number == 1


def test_a_hand_is_no_object(roll: Callable[..., Path]) -> None:
    def poke(frames: Frames) -> Frames:
        poked = frames.copy()
        for t in range(30, 60):
            cv2.rectangle(poked[t], (70 - t // 10, 0), (89, 25 + t // 10), (200, 160, 140), -1)
        return poked

    finding = found(roll(swing(100), poke))
    assert finding.movers is not None
    assert finding.movers.number == 1
    assert finding.disturbed == pytest.approx(0.3, abs=0.1)
    assert finding.box[2] < 60


def test_disagreeing_frames_give_no_number(roll: Callable[..., Path]) -> None:
    xy = np.concatenate([swing(50, 2), swing(50, 3)[:, [0, 2]][:, :1].repeat(2, axis=1)])
    finding = found(roll(xy))  # two balls, then one hidden by the other
    assert finding.movers is not None
    assert finding.movers.number is None
