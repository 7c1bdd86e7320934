"""Trackers that follow a dense flow field from a start: 2a "simple" and 2b "blob" of the paper's comparison."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.baselines.blobs import blobs, kept
from physpipe.core.params import Section
from physpipe.trackers.base import Trajectory, required

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


class FlowParams(Section):
    """How a flow field is followed."""

    disc_radii: float = Field(gt=0)
    """Radius of the disc whose mean flow moves the object, in the object's."""
    blob_px: float = Field(gt=0)
    """Speed that the object must have for a blob to be looked for, pixels a frame relative to the median flow."""
    blob_share: float = Field(gt=0, lt=1)
    """Share of the object's speed above which a pixel belongs to a blob."""
    reach_radii: float = Field(gt=0)
    """Distance from the object, in its radii, within which a blob is looked for."""


class FlowSimple:
    """2a: the flow at the object moves it."""

    def __init__(self, flow: Flow, params: FlowParams, radius_px: float):
        self.flow, self.params, self.radius_px = flow, params, radius_px

    def track(
        self,
        frames: NDArray[np.uint8],
        start: NDArray[np.floating] | None = None,
        ignore: NDArray[np.bool_] | None = None,
    ) -> Trajectory:
        """From `start` on by the mean flow in a disc; lost while that disc lies outside the frame or is ignored."""
        place = required(start, frames, "dense flow").astype(np.float64)
        xy, score = np.full((len(frames), 2), np.nan, np.float32), np.zeros(len(frames), np.float32)
        xy[0], score[0] = place, 1
        for t in range(1, len(frames)):
            flow, hidden = self.flow(frames[t - 1], frames[t]), None if ignore is None else ignore[t - 1]
            place = self.settled(place, flow, hidden)
            disc = self.disc(place, self.params.disc_radii, flow)
            near = kept(disc, hidden)
            if near.any():
                place = place + flow[near].mean(axis=0)
                xy[t], score[t] = place, near.sum() / disc.sum()
        return Trajectory(xy, score)

    def settled(
        self, place: NDArray[np.float64], flow: NDArray[np.float32], hidden: NDArray[np.bool_] | None
    ) -> NDArray[np.float64]:
        """Where the object is taken to be before the flow moves it."""
        return place

    def disc(self, centre: NDArray[np.float64], radii: float, flow: NDArray[np.float32]) -> NDArray[np.bool_]:
        """(H, W) pixels within `radii` of the object's radius from `centre`."""
        rows, columns = np.ogrid[: flow.shape[0], : flow.shape[1]]
        return (columns - centre[0]) ** 2 + (rows - centre[1]) ** 2 <= (radii * self.radius_px) ** 2


class FlowBlob(FlowSimple):
    """2b: 2a, put right by the centre of the blob that moves there, if there is one."""

    def settled(
        self, place: NDArray[np.float64], flow: NDArray[np.float32], hidden: NDArray[np.bool_] | None
    ) -> NDArray[np.float64]:
        """The centre of mass of the largest blob in reach, else `place`.

        A pixel weighs as much as it moves, no more than the object: else a hand that passes by would outweigh it.
        """
        apart = flow - np.median(flow, axis=(0, 1))
        core = kept(self.disc(place, self.params.disc_radii, flow), hidden)
        speed_px = float(np.linalg.norm(apart[core].mean(axis=0))) if core.any() else 0.0
        if speed_px < self.params.blob_px:
            return place
        weight = np.linalg.norm(apart, axis=2).clip(max=speed_px) * self.disc(place, self.params.reach_radii, flow)
        centres = blobs(kept(weight, hidden), self.params.blob_share * speed_px, least_px2=1).xy
        return centres[0] if len(centres) else place


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
