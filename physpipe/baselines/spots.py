"""trackpy (Crocker and Grier 1996), told the objects' diameter: spots of that size that look unlike the rest."""

import importlib
import warnings
from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.baselines.blobs import NOTHING, Found, kept
from physpipe.core.colour import srgb_to_lab
from physpipe.core.errors import InputError
from physpipe.core.params import Section


class TrackpyParams(Section):
    """What `trackpy.locate` is told beside the diameter."""

    noise_px: float = Field(gt=0)
    """Standard deviation of the Gaussian that suppresses noise first."""
    spots: int = Field(ge=1)
    """Spots looked for in a frame, at most."""


def odd_diameter_px(radius_px: float) -> int:
    """The odd whole number nearest to the diameter, the larger of two as near: what `trackpy.locate` takes."""
    return 2 * int(radius_px) + 1


def spots(
    frames: NDArray[np.uint8], ignore: NDArray[np.bool_] | None, params: TrackpyParams, diameter_px: int
) -> list[Found]:
    """The spots of each frame, heaviest first; half a diameter from the frame's edge trackpy finds none.

    The channel is the distance in LAB from the frame's median colour: a ball stands out bright whether it is lighter,
    darker or only of another hue, and rests as visibly as it moves. Raises InputError without the package.
    """
    trackpy = _trackpy()
    found = []
    for t, frame in enumerate(frames):
        lab = srgb_to_lab(frame)
        unlike = np.linalg.norm(lab - np.median(lab, axis=(0, 1)), axis=2)
        with warnings.catch_warnings():  # it warns of frames without a spot
            warnings.simplefilter("ignore")
            image = kept(unlike, None if ignore is None else ignore[t])
            table = trackpy.locate(image, diameter_px, noise_size=params.noise_px, topn=params.spots, engine="python")
        table = table.sort_values("mass", ascending=False, kind="stable")
        mass = table["mass"].to_numpy(float)
        found.append(Found(table[["x", "y"]].to_numpy(float), mass / mass.sum()) if len(mass) else NOTHING)
    return found


def _trackpy() -> ModuleType:
    try:
        return importlib.import_module("trackpy")
    except ImportError:
        mend = "`pip install trackpy` (extra `bench`), or drop it from `baselines.names`"
        raise InputError("tracker `trackpy`", "the package trackpy is not installed", mend) from None
