"""Film made for the tests of ingest: a ball that rolls over a textured ground, encoded losslessly."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from worlds import encoded

H, W = 64, 96


def rolling(
    count: int = 60,
    start: int = 15,
    stop: int = 45,
    speed: float = 1.0,
    noise: float = 0.0,
    drift: float = 0.0,
    wobble: float = 0.0,
    radius: float = 4.0,
    seed: int = 0,
    height: int = H,
    width: int = W,
) -> NDArray[np.uint8]:
    """(count, height, width, 3): a ball that moves `speed` px a frame from frame `start` to `stop`.

    `noise` grey levels, relative light `drift` and camera `wobble` in px are nuisances; `radius` 0 leaves no ball.
    """
    rng = np.random.default_rng(seed)
    ground = cv2.GaussianBlur(rng.uniform(0, 255, (height + 20, width + 20, 3)), (0, 0), 2.0)
    ground = (ground - ground.mean()) * 3 + 120
    xs, ys = np.meshgrid(np.arange(width), np.arange(height))
    frames = []
    for t in range(count):
        shift = wobble * np.array([np.sin(0.3 * t), np.cos(0.23 * t)])
        to = np.array([[1, 0, shift[0] - 10], [0, 1, shift[1] - 10]])
        frame = cv2.warpAffine(ground, to, (width, height))
        x = 20 + speed * np.clip(t - start, 0, stop - start) + shift[0]
        ball = np.clip(radius + 0.5 - np.hypot(xs - x, ys - height / 2 - shift[1]), 0, float(radius > 0))[..., None]
        frame = frame * (1 - ball) + ball * np.array([230, 60, 40])
        light = 1 + drift * np.sin(2 * np.pi * t / count)
        frames.append(np.clip(frame * light + rng.normal(0, noise, frame.shape), 0, 255).round().astype(np.uint8))
    return np.stack(frames)


@pytest.fixture
def roll() -> Callable[..., NDArray[np.uint8]]:
    return rolling


@pytest.fixture
def film() -> Callable[..., Path]:
    return encoded


@pytest.fixture
def ingest_params() -> dict[str, Any]:
    """A legal section `ingest`, to be changed by each test."""
    return {
        "fps": None,
        "source_fps": None,
        "crop": None,
        "size": 32,
        "trim": None,
        "max_gap_s": 0.2,
        "clip_frames": 20,
        "min_frames": 5,
        "split": {"valid": 0.0, "test": 0.0},
        "allow_unreadable": False,
    }


@pytest.fixture
def trim() -> dict[str, Any]:
    """Legal trim params."""
    return {"lag": 5, "block_px": 8, "wobble_px": 0.1, "threshold": 15, "min_moving": 3, "margin": 2}
