"""Dense optical flow between two frames that needs no training, by OpenCV, and what every dense flow is."""

from collections.abc import Callable
from functools import partial

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section

Flow = Callable[[NDArray[np.uint8], NDArray[np.uint8]], NDArray[np.float32]]
"""Two RGB frames (H, W, 3) to (H, W, 2) pixels: how far each pixel of the first has moved in the second."""


class DisParams(Section):
    """Dense inverse search (Kroeger et al. 2016)."""

    finest_scale: int = Field(ge=0)
    """Halvings of the frame at the finest scale; 0 is the full frame."""
    patch_px: int = Field(ge=4)
    """Side of the patches matched."""
    stride_px: int = Field(ge=1)
    """Step between patches, at most their side."""
    refinements: int = Field(ge=0)
    """Steps of the variational refinement, which smooths the field."""


class FarnebackParams(Section):
    """Polynomial expansion (Farneback 2003)."""

    levels: int = Field(ge=1)
    """Scales of the pyramid, each half the one before."""
    window_px: int = Field(ge=3)
    """Side of the window over which displacements are averaged."""
    rounds: int = Field(ge=1)
    """Iterations at each scale."""
    neighbours_px: int = Field(ge=3)
    """Side of the neighbourhood that a polynomial is fitted to."""
    spread_px: float = Field(gt=0)
    """Standard deviation of the Gaussian that weighs it."""


class Remembered:
    """A flow computed once for each pair of frames: 2a and 2b, and every object of a clip, ask for the same ones."""

    def __init__(self, flow: Flow):
        self.flow = flow
        self.known: dict[tuple[bytes, bytes], NDArray[np.float32]] = {}

    def __call__(self, frame: NDArray[np.uint8], following: NDArray[np.uint8]) -> NDArray[np.float32]:
        """The field, which is not to be written to."""
        pair = frame.tobytes(), following.tobytes()
        if pair not in self.known:
            self.known[pair] = self.flow(frame, following)
        return self.known[pair]


def classical_flows(dis_params: DisParams, farneback_params: FarnebackParams) -> dict[str, Flow]:
    """The flows by name; picklable."""
    return {"dis": partial(dis, params=dis_params), "farneback": partial(farneback, params=farneback_params)}


def dis(frame: NDArray[np.uint8], following: NDArray[np.uint8], params: DisParams) -> NDArray[np.float32]:
    """On grey. OpenCV's presets work on half the frame and smooth the field, which washes small objects away."""
    method = cv2.DISOpticalFlow.create()
    method.setFinestScale(params.finest_scale)
    method.setPatchSize(params.patch_px)
    method.setPatchStride(params.stride_px)
    method.setVariationalRefinementIterations(params.refinements)
    return np.asarray(method.calc(_grey(frame), _grey(following), _empty(frame)), np.float32)


def farneback(frame: NDArray[np.uint8], following: NDArray[np.uint8], params: FarnebackParams) -> NDArray[np.float32]:
    """On grey. Wide windows, as in OpenCV's samples, mix small objects with what is around them."""
    scales = 0.5, params.levels, params.window_px, params.rounds
    polynomial = params.neighbours_px, params.spread_px
    field = cv2.calcOpticalFlowFarneback(_grey(frame), _grey(following), _empty(frame), *scales, *polynomial, 0)
    return np.asarray(field, np.float32)


def _grey(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.asarray(cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY), np.uint8)


def _empty(frame: NDArray[np.uint8]) -> NDArray[np.float32]:
    return np.zeros((*frame.shape[:2], 2), np.float32)
