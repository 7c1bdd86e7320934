"""Pictures to H.264 that plays everywhere, each at its own time."""

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from physpipe.io.atomic import replacing

TICK = Fraction(1, 90000)
"""Seconds; the unit of the times in the file."""
# One thread, no macroblock tree: else x264 gives other bytes in a few runs of a hundred (AVX-512 machines).
OPTIONS = {"crf": "20", "preset": "medium", "threads": "1", "mbtree": "0"}
Picture = NDArray[np.uint8]


def encode(path: Path, film: Iterable[tuple[float, Picture]], fps: float) -> None:
    """Writes an MP4 (yuv420p) of (seconds, (H, W, 3) RGB), all of one size; odd sides get a black row or column.

    `fps` is the usual rate, for players that want one.
    """
    with replacing(path) as temporary, av.open(temporary, "w", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000), options=OPTIONS)
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = TICK
        for number, (time_s, picture) in enumerate(film):
            whole = even(picture)
            if number == 0:
                stream.height, stream.width = whole.shape[:2]
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(whole), format="rgb24")
            frame.pts, frame.time_base = round(time_s / TICK), TICK
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


def even(picture: Picture) -> Picture:
    """Adds a black row or column where a side is odd: yuv420p has no odd sizes."""
    height, width = picture.shape[:2]
    return np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)))
