"""Trackers that follow a dense flow field from a start: 2a "simple" and 2b "blob" of the paper's comparison."""

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.baselines.blobs import blobs, kept
from physpipe.core.params import Section
from physpipe.flownet.classical import Flow
from physpipe.trackers.base import Trajectory, required


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
