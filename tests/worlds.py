"""Small films whose truth is known, shared by tests; never square."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from physpipe.core.geometry import Geometry
from physpipe.io import clips as clip_files
from physpipe.io.clips import SPLITS, Clip, ClipSet

HEIGHT, WIDTH = 40, 56
RED, BLUE = (220, 40, 30), (30, 60, 230)


def orbit(frames: int, phase: float, shrink: float = 1.0) -> NDArray[np.float64]:
    """(frames, 2) pixels on an ellipse inside the frame."""
    angle = phase + 0.13 * np.arange(frames)
    return np.stack([27 + 19 * shrink * np.cos(angle), 19 + 12 * shrink * np.sin(angle)], axis=1)


def draw(xy: NDArray[np.float64], colours: list[tuple[int, int, int]], seed: int) -> NDArray[np.uint8]:
    """(T, H, W, 3) frames of soft discs of 3 px radius at (T, K, 2) pixels, on a still texture, with noise."""
    rng = np.random.default_rng(seed)
    ground = rng.uniform(90, 130, (HEIGHT, WIDTH, 1)) + rng.uniform(-10, 10, 3)
    frames = np.repeat(ground[None], len(xy), axis=0)
    ys, xs = np.mgrid[:HEIGHT, :WIDTH]
    for number, colour in enumerate(colours):
        apart = np.hypot(xs - xy[:, number, 0, None, None], ys - xy[:, number, 1, None, None])
        cover = np.clip(3.5 - apart, 0, 1)[..., None]
        frames = frames * (1 - cover) + cover * np.array(colour)
    return (frames + rng.normal(0, 2, frames.shape)).clip(0, 255).astype(np.uint8)


def save_clips(folder: Path, films: list[NDArray[np.uint8]]) -> ClipSet:
    """A clip set of 80-fps films; of every five, three are for training, one validates and one tests."""
    made = []
    for number, frames in enumerate(films):
        length = len(frames)
        split = SPLITS[max(0, number % 5 - 2)]
        geometry = Geometry(0, 0, frames.shape[2], frames.shape[1], frames.shape[2], frames.shape[1])
        seconds = np.arange(length) / 80
        source = np.arange(length, dtype=np.int32)
        name = f"clip_{number:02d}"
        ok = np.full(length, "ok")
        made.append(Clip(name, split, f"{name}.mp4", geometry, frames, seconds, source, seconds, ok))
    clip_files.save(folder, made)
    return ClipSet(folder)


def ball_film(
    xy: NDArray[np.float64], radius_px: float, seed: int, pattern: float = 30, height: int = 60, width: int = 90
) -> NDArray[np.uint8]:
    """(T, H, W, 3) frames of discs, red and blue in turn, that move along (T, K, 2) pixels on a still texture.

    A disc's pattern, of `pattern` grey levels, moves with it; its edge is drawn from 4 x 4 samples a pixel. No noise.
    """
    rng = np.random.default_rng(seed)
    ground = _texture(rng, (height, width, 3), 3, 12) + 110
    skin = _texture(rng, (64, 64, 1), 3, pattern)
    offsets = (np.arange(4) - 1.5) / 4
    ys, xs = np.mgrid[:height, :width].astype(np.float64)
    frames = []
    for places in xy:
        frame = ground.copy()
        for number, (x, y) in enumerate(places):
            inside = [np.hypot(xs + dx - x, ys + dy - y) <= radius_px for dx in offsets for dy in offsets]
            cover = np.mean(inside, axis=0)[..., None]
            own = ndimage.map_coordinates(skin[..., 0], [ys - y + 32, xs - x + 32], order=1, mode="wrap")[..., None]
            frame = frame * (1 - cover) + cover * (np.array([RED, BLUE][number % 2]) + own)
        frames.append(frame)
    return np.array(frames).round().clip(0, 255).astype(np.uint8)


def _texture(rng: np.random.Generator, shape: tuple[int, ...], blur_px: float, spread: float) -> NDArray[np.float64]:
    """Blurred noise of standard deviation `spread`."""
    noise = ndimage.gaussian_filter(rng.normal(size=shape), (blur_px / 2, blur_px / 2, 0), mode="wrap")
    return spread * noise / noise.std()


def encoded(path: Path, frames: Sequence[NDArray[np.uint8]], times_s: Sequence[float]) -> Path:
    """A lossless video of `frames` at `times_s` (to the millisecond in .mkv)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(path, "w") as container:
        stream = container.add_stream("ffv1", rate=100)
        stream.height, stream.width, stream.pix_fmt = *frames[0].shape[:2], "bgr0"
        stream.codec_context.time_base = Fraction(1, 1000)
        for pixels, time_s in zip(frames, times_s, strict=True):
            frame = av.VideoFrame.from_ndarray(pixels, format="rgb24").reformat(format="bgr0")
            frame.pts, frame.time_base = round(1000 * time_s), Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path
