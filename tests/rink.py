"""A small filmed set to annotate: two clips of two discs each, in frames that are not square."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path
from threading import Thread
from types import SimpleNamespace

import numpy as np
from waitress import wasyncore

from physpipe.annotator import serving
from physpipe.annotator.app import Desk
from physpipe.core.geometry import Geometry
from physpipe.io.clips import Clip, save

H, W, T = 48, 64, 54
GEOMETRY = Geometry(30, 10, 3 * W, 3 * H, W, H)
PARAMS = """\
ground_truth: {candidates: 4, flat_lab: 2, smoothness_per_px2: 0.001, lost_score: 0.4, lost_switch: 1}
run: {datasets: [rink, empty]}
datasets:
  rink: {motion: {objects: 2}}
  bowls: {motion: {objects: 1}, simulate: {}}
"""
ADDRESS = "127.0.0.1:8765"
CLIPS, ANNOTATIONS = Path("data/clips/rink"), Path("data/annotations/rink")


def path(k: int) -> np.ndarray:
    """(T, 2) clip pixels: disc k rolls to the right, the second one lower and slower."""
    t = np.arange(T)
    return np.stack([10 + (0.8 - 0.2 * k) * t, 13 + 22 * k + 2 * np.sin(t / 8)], axis=1)


@lru_cache
def film() -> np.ndarray:
    """(T, H, W, 3) uint8 frames of the two discs."""
    rows, columns = np.mgrid[:H, :W]
    frames = np.full((T, H, W, 3), 110.0)
    for k, colour in enumerate(([220, 60, 40], [40, 90, 210])):
        for t, (x, y) in enumerate(path(k)):
            inside = np.clip(5 - np.hypot(columns - x, rows - y), 0, 1)[..., None]
            frames[t] = inside * colour + (1 - inside) * frames[t]
    return frames.round().astype(np.uint8)


def save_clips() -> None:
    """The clips `a` and `b`; one frame was not decoded."""
    times, status = np.arange(T) / 30, np.array(["ok"] * T, dtype=object)
    status[9] = "decode_error"
    numbers = 5 + np.arange(T, dtype=np.int32)
    save(CLIPS, [Clip(n, "test", f"{n}.mp4", GEOMETRY, film(), times, numbers, times, status) for n in ("a", "b")])


@contextmanager
def running(desk: Desk, port: int = 0) -> Iterator[SimpleNamespace]:
    """The page of `desk`, served for the length of the block: its `url` and `port`."""
    server, url = serving.open_server(desk, port)
    thread = Thread(target=server.run, daemon=True)
    thread.start()
    try:
        yield SimpleNamespace(url=url, port=int(url.rstrip("/").rsplit(":", 1)[1]))
    finally:
        server.trigger.pull_trigger(partial(wasyncore.close_all, server._map))  # cuts every connection, as a kill does
        thread.join()
        server.task_dispatcher.shutdown()
