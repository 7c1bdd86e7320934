"""Pictures to a film, each at its own time: H.264 that plays everywhere, or a WebP picture that moves in a web page."""

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple, cast

import av
import numpy as np
from numpy.typing import NDArray

from physpipe.io.atomic import replacing

TICK = Fraction(1, 90000)
"""Seconds; the unit of the times in the file."""
Picture = NDArray[np.uint8]


class Format(NamedTuple):
    """How a film is written; names and options are FFmpeg's."""

    codec: str
    options: dict[str, str]
    container: dict[str, str]


FORMATS = {
    # One thread, no macroblock tree: else x264 gives other bytes in a few runs of a hundred (AVX-512 machines).
    "mp4": Format(
        "libx264", {"crf": "20", "preset": "medium", "threads": "1", "mbtree": "0"}, {"movflags": "faststart"}
    ),
    "webp": Format("libwebp_anim", {"quality": "75", "compression_level": "4"}, {"loop": "0"}),
}
"""Suffix to format; `webp` plays for ever, as pictures in a web page do."""


def encode(path: Path, film: Iterable[tuple[float, Picture]], fps: float) -> None:
    """Writes (seconds, (H, W, 3) RGB), all of one size, in the format that the suffix of `path` names.

    Odd sides get a black row or column; `fps` is the usual rate, for players that want one.
    """
    form = FORMATS[path.suffix.removeprefix(".")]
    with replacing(path) as temporary, av.open(temporary, "w", options=form.container) as container:
        rate = Fraction(fps).limit_denominator(1000)
        stream = cast(av.VideoStream, container.add_stream(form.codec, rate=rate, options=form.options))
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
