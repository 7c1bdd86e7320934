"""From a point on an object to its centre: matching with its own mean look, made round (ours).

A heat map may settle on an edge or a highlight, always the same one: a constant offset (paper section 4.1). Round
objects have a centre that needs no label. The mean look of a clip's detections, averaged over all directions, is a
disc around the detection; where it fits best is the object's middle. Light from one side and a shadow are not round:
what is compared is the mix of colours that tells the object from its surroundings most surely (Fisher's linear
discriminant), in which shading counts as noise.
"""

import numpy as np
from numpy.typing import NDArray

from physpipe.core.colour import srgb_to_lab
from physpipe.trackers.look import Floats, Look, RefineParams, mean_look


def refined(frames: NDArray[np.uint8], xy: NDArray[np.floating], params: RefineParams) -> Floats:
    """(T, 2) middles of the object on which (T, 2) positions in (T, H, W, 3) frames lie; NaN stays NaN."""
    seen = np.flatnonzero(np.isfinite(xy).all(axis=1))
    middles = xy.astype(np.float32)
    if len(seen):
        middles[seen] = _centred(frames[seen], middles[seen], params)[0]
    return middles


class Searcher:
    """Finds an object again by the look that it had."""

    def __init__(self, frames: NDArray[np.uint8], xy: NDArray[np.floating], params: RefineParams):
        """From (N, H, W, 3) frames in which the object was at (N, 2)."""
        self.params = params
        self.look = _centred(frames, xy.astype(np.float32), params)[1]

    def near(self, frame: NDArray[np.uint8], xy: NDArray[np.floating], search_px: int) -> tuple[Floats, float] | None:
        """(2,) place in (H, W, 3), within `search_px` of (2,) along x and y, where it fits best, and how well.

        None where nothing fits.
        """
        corner, half = np.rint(xy).astype(int), len(self.look.template) // 2 + search_px
        offset, fit = self.look.fit(srgb_to_lab(_cut(frame[None], corner[None], half))[0], search_px)
        return (corner + offset, fit) if fit >= self.params.least_fit else None


def _centred(frames: NDArray[np.uint8], xy: Floats, params: RefineParams) -> tuple[Floats, Look]:
    """(N, 2) middles in (N, H, W, 3) frames, and the look that they were found by."""
    corners = np.rint(xy).astype(int)
    patches = srgb_to_lab(_cut(frames, corners, params.reach_px + params.search_px))
    start = (xy - corners).astype(np.float32)  # from each patch's middle
    offsets, look = start, None
    for _ in range(params.rounds):
        look = mean_look(patches, offsets, params)
        fits = [look.fit(patch, params.search_px) for patch in patches]
        chosen = [new if fit >= params.least_fit else old for (new, fit), old in zip(fits, start, strict=True)]
        offsets = np.stack(chosen)
    assert look is not None  # there is at least one round
    return corners + offsets, look


def _cut(frames: NDArray[np.uint8], middle: NDArray[np.intp], half: int) -> NDArray[np.uint8]:
    """(N, 2 half + 1, 2 half + 1, 3) patches around whole pixels (N, 2), the frame's edge repeated outwards."""
    around = np.arange(-half, half + 1)
    rows = np.clip(middle[:, 1:] + around, 0, frames.shape[1] - 1)
    columns = np.clip(middle[:, :1] + around, 0, frames.shape[2] - 1)
    return frames[np.arange(len(frames))[:, None, None], rows[:, :, None], columns[:, None, :]]
