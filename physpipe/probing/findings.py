"""What a look at one recording found, in pixels of its upright frame."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physpipe.io import folders
from physpipe.probing import camera
from physpipe.probing.movers import Movers, movers
from physpipe.probing.sampling import Pair, Sample, sample
from physpipe.probing.scene import Scene, steadied

TYPICAL = 0.95
"""Quantile over frames that stands for the worst usual one."""
SAME_GREY = 0.02
"""Mean difference in grey levels below which a frame is the one before once more."""
MEASURED = 12
"""Pairs whose jump and sharpness are measured."""


@dataclass(frozen=True)
class Finding:
    """One recording."""

    source: str
    """Its path inside the folder."""
    stem: str
    """The same without a video's suffix: what its clips are named by."""
    film: Sample
    scene: Scene
    movers: Movers | None
    """None where nothing moves."""
    jump_px: float
    """How far the whole picture moves between two frames."""
    travel_px: float
    """How far it gets away from where it was."""
    flicker: float
    """Relative change of brightness between two frames."""
    drift: float
    """Range of the brightness over the recording, relative."""
    blur_px: float
    """Standard deviation of the blur of the sharpest edges; NaN without edges."""
    repeated: float
    """Share of the frames that are the one before once more."""

    @property
    def diameter_px(self) -> float:
        """Of an object; NaN where nothing moves."""
        return np.nan if self.movers is None else self.movers.diameter * self.film.reduction

    @property
    def speed_px(self) -> float:
        """Pixels a frame of the fastest usual motion; NaN where nothing could be followed."""
        speeds = np.empty(0) if self.movers is None else self.movers.speeds
        return float(np.quantile(speeds, TYPICAL)) * self.film.reduction if len(speeds) else np.nan

    @property
    def moving(self) -> float:
        """Share of the looks since whose predecessor something moved."""
        return float(self.scene.moving.mean())

    @property
    def disturbed(self) -> float:
        """Share of the looks that show something larger than the objects."""
        return 0.0 if self.movers is None else float(np.mean([bool(each) for each in self.movers.others]))

    @property
    def span(self) -> tuple[float, float]:
        """Places, 0 to 1, between which something moves."""
        places = [pair.place for pair, moves in zip(self.film.pairs, self.scene.moving, strict=True) if moves]
        return (places[0], places[-1]) if places else (0.0, 0.0)

    @property
    def box(self) -> tuple[int, int, int, int] | None:
        """Left, top, right, bottom of all that objects covered; None where nothing moves."""
        if self.movers is None:
            return None
        left, top, right, bottom = (round(edge * self.film.reduction) for edge in self.movers.box)
        return left, top, min(right, self.film.width), min(bottom, self.film.height)


def look(path: Path, folder: Path, source_fps: float | None) -> Finding:
    """Looks at one recording of `folder`; raises InputError where it cannot be read."""
    film = sample(path, source_fps)
    scene = steadied(film.pairs)
    some = film.pairs[:: -(-len(film.pairs) // MEASURED)]
    jumps = [np.hypot(*camera.shift(camera.grey(pair.first), camera.grey(pair.second))) for pair in some]
    blurs = [camera.blur_px(camera.grey(pair.first)) for pair in some]
    return Finding(
        source=folders.source(path, folder),
        stem=folders.stem(path, folder),
        film=film,
        scene=scene,
        movers=movers(scene),
        jump_px=float(np.quantile(jumps, TYPICAL)) * film.reduction,
        travel_px=float(np.ptp(scene.shifts.reshape(-1, 2), axis=0).max()) * film.reduction,
        flicker=float(np.quantile(np.abs(scene.gains[1] / scene.gains[0] - 1), TYPICAL)),
        drift=float(np.ptp(scene.gains)),
        blur_px=float(np.median(blurs)) * film.reduction,
        repeated=float(np.mean([_same(pair) for pair in film.pairs])),
    )


def _same(pair: Pair) -> bool:
    apart = pair.first.astype(np.int16) - pair.second
    return float(np.abs(apart).mean()) < SAME_GREY
