"""One short film a data set: test clips with what was true, tracked and forecast."""

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section
from physpipe.io.atomic import replacing
from physpipe.report.overlays import draw, marks_of
from physpipe.report.run import Evidence

CAPTION_LINE_PX = 16
Picture = NDArray[np.uint8]


class FilmParams(Section):
    """How the overlay film of a data set looks."""

    clips: int = Field(ge=1)
    """Number of test clips in it, at most."""
    fps_at_most: float = Field(gt=0)
    """Frames a second when played; a faster camera's film is slowed to it."""
    kilobytes: int = Field(gt=0)
    """Aimed-at size of the file, an upper bound that the encoder keeps on average."""


def shown_clips(evidence: Evidence, count: int) -> list[str]:
    """Up to `count` clips of the test split, spread over it; of all clips where there is no test split."""
    names = evidence.clips.names("test") or evidence.clips.names()
    spread = np.linspace(0, len(names) - 1, min(count, len(names))).round().astype(int)
    return [names[index] for index in spread]


def write_film(path: Path, evidence: Evidence, predictor: str, upscale: int, trail: int, params: FilmParams) -> None:
    """Writes H.264 (yuv420p, even sizes) at the clips' own rate, or slower by a factor that the caption states."""
    names = shown_clips(evidence, params.clips)
    rate = _rate(evidence, names)
    played = min(rate, params.fps_at_most)
    pace = f"{rate:.3g} fps" + (f", played {rate / played:.2g} x slower" if played < rate else "")
    pictures = _pictures(evidence, names, f"dashes: {predictor}; {pace}", upscale, trail)
    frames = sum(len(evidence.clips.frames(name)) for name in names)
    _encode(path, pictures, played, params.kilobytes * 8000 * played / frames)


def _rate(evidence: Evidence, names: list[str]) -> float:
    steps = np.concatenate([np.diff(evidence.clips.times_s(name)) for name in names])
    return 1 / float(np.median(steps)) if len(steps) else 1.0


def _pictures(evidence: Evidence, names: list[str], note: str, upscale: int, trail: int) -> Iterator[Picture]:
    for name in names:
        frames, marks = evidence.clips.frames(name), marks_of(evidence, name)
        truth = "ring: truth" if marks.truth.size else "no truth"
        caption = _caption([name, f"{truth}; dot: track", note], frames.shape[2] * upscale)
        for t, frame in enumerate(frames):
            yield _even(np.concatenate([caption, draw(frame, marks, t, upscale, trail)]))


def _caption(lines: list[str], width: int) -> Picture:
    """White lines of text on black, `width` pixels wide, in as small a type as that takes."""
    size_px = min(12.0, 1.7 * width / max(map(len, lines)))
    figure = Figure(figsize=(width / 100, CAPTION_LINE_PX * len(lines) / 100), dpi=100, facecolor="black")
    for number, line in enumerate(lines):
        height = 1 - (number + 0.5) / len(lines)
        figure.text(4 / width, height, line, color="white", size=size_px * 0.72, va="center")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3]


def _even(picture: Picture) -> Picture:
    """Adds a black row or column where a side is odd: yuv420p has no odd sizes."""
    height, width = picture.shape[:2]
    return np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)))


def _encode(path: Path, pictures: Iterator[Picture], fps: float, bits_per_second: float) -> None:
    # One thread, no macroblock tree: else x264 gives other bytes in a few runs of a hundred (AVX-512 machines).
    limits = {"maxrate": str(int(bits_per_second * 0.9)), "bufsize": str(int(bits_per_second))}
    options = {"crf": "23", "preset": "medium", "threads": "1", "mbtree": "0", **limits}
    with replacing(path) as temporary, av.open(temporary, "w", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000), options=options)
        stream.pix_fmt = "yuv420p"
        for number, picture in enumerate(pictures):
            if number == 0:
                stream.height, stream.width = picture.shape[:2]
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")))
        container.mux(stream.encode())
