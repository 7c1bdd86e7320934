"""A small tracker and small films that it learns in seconds, shared by tests; never square."""

import math
from pathlib import Path

import numpy as np
import worlds
from numpy.typing import NDArray

from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams
from physpipe.tracker_learning.moments import MomentParams
from physpipe.tracker_learning.recipe import RecipeParams, TrackerParams
from physpipe.trackers.detectors import TrackingParams
from physpipe.trackers.learned import ReadoutParams
from physpipe.trackers.linking import LinkParams
from physpipe.trackers.sequential import MaskParams
from physpipe.tracknet.detector import DetectorParams
from physpipe.tracknet.discriminator import DiscriminatorParams
from physpipe.tracknet.model import BottleneckParams, LossParams, TrackNetParams
from physpipe.tracknet.places import PeakParams
from physpipe.tracknet.signals import LockParams, SignalParams


def params(steps: int, warm: int, rest: int = 40, several: bool = False) -> TrackerParams:
    """Starts of `steps`, `warm` of them on motion alone, and `rest` steps; `several`: all objects at once."""
    fit = FitParams(
        steps=steps,
        batch_size=8,
        learning_rate=5e-3,
        final_rate=0.1,
        warmup_steps=5,
        weight_decay=0,
        clip_norm=1,
        valid_every=20,
        patience=100,
        precision="float32",
    )
    net = TrackNetParams(
        detector=DetectorParams(width=8, layers=1, stride=4),
        discriminator=DiscriminatorParams(width=32, shape_only=True),
        losses=LossParams(causality=1, entropy=0.01, equivariance=0.001, motion=0.3 if several else 0),
        bottleneck=BottleneckParams(start_px=0.02, end_px=0.4, growth=1.05, winning=0.5),
        negatives=8,
        turned_share=0.4,
        mirrored=True,
        flicker=0.1,
        warm_start_steps=warm,
        peaks=PeakParams(slots=3, apart_px=7, window_px=6, least_mass=0.15, even=0.02, nearby_cells=5)
        if several
        else None,
    )
    recipe = RecipeParams(
        net=net,
        moments=MomentParams(strides=[1, 2], background_frames=15),
        starts=2,
        start=fit,
        rest=fit.model_copy(update={"steps": rest}),
    )
    return TrackerParams(
        recipe="small",
        recipes={"small": recipe},
        signals=SignalParams(noise_px=0.4, batches=3, siamese_weight=0.1, near_px=6),
        lock=LockParams(order_accuracy=0.8, siamese_px=3, entropy_nats=3.5, motion_share=0.3, extent_px=0.5),
        tracking=TrackingParams(
            readout=ReadoutParams(window_px=9, batch_frames=32),
            mask=MaskParams(radius_px=8),
            link=LinkParams(
                gate_px=8,
                apart_px=2,
                memory_frames=3,
                least_share=0.5,
                doubt_px=2,
                still_px=1,
                search_px=5,
                look_frames=10,
                speed_frames=2,
            ),
            refine=None,
        ),
        least_motion=0.15,
    )


def orbits(
    folder: Path, colours: tuple[tuple[int, int, int], ...] = (worlds.RED,), post: bool = False
) -> tuple[ClipSet, dict[str, NDArray[np.float64]]]:
    """Ten clips of one or two balls half an orbit apart, and their truth (T, K, 2).

    A `post`, 4 px wide, stands before the ball's way, and a blue ball lies still beside it.
    """
    phases = [0.6 * number for number in range(10)]
    truth = [
        np.stack([worlds.orbit(24, phase + math.pi * each) for each in range(len(colours))], axis=1) for phase in phases
    ]
    films = [worlds.draw(xy, list(colours), seed) for seed, xy in enumerate(truth)]
    if post:
        still = np.full((24, 1, 2), [27.0, 19.0])
        films = [worlds.draw(np.concatenate([xy, still], 1), [*colours, worlds.BLUE], n) for n, xy in enumerate(truth)]
        for film in films:
            film[:, :, 36:40] = 90
    clips = worlds.save_clips(folder, films)
    return clips, dict(zip(clips.names(), truth, strict=True))
