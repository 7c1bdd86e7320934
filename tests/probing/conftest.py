"""Film with a known motion: balls on a still texture, without loss, in a frame that is not square."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from worlds import ball_film, encoded

HEIGHT, WIDTH = 60, 90
RADIUS_PX = 5.0

Film = NDArray[np.uint8]


def swing(frames: int, objects: int = 1) -> NDArray[np.float64]:
    """(T, K, 2) pixels: objects side by side swing up and down, 1 px a frame at most."""
    phase = 2 * np.pi * np.arange(frames)[:, None] / 80 + np.arange(objects)
    x = 30 + 30 * np.arange(objects) + 8 * np.sin(phase / 2)
    return np.stack([x, 30 + 12 * np.sin(phase)], axis=-1)


@pytest.fixture
def roll(tmp_path: Path) -> Callable[..., Path]:
    """A recording of balls at (T, K, 2) pixels, its frames changed by `spoil`, at `fps` or at `times_s`."""

    def make(
        xy: NDArray[np.float64] | None = None,
        spoil: Callable[[Film], Film] = lambda frames: frames,
        name: str = "film/a.mkv",
        fps: float = 100.0,
        times_s: NDArray[np.float64] | None = None,
    ) -> Path:
        frames = spoil(ball_film(swing(100) if xy is None else xy, RADIUS_PX, 3, height=HEIGHT, width=WIDTH))
        return encoded(tmp_path / name, frames, np.arange(len(frames)) / fps if times_s is None else times_s)

    return make
