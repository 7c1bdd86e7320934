"""Whether tracks stay with their objects: HOTA, IDF1 and identity switches; pure functions of arrays.

As TrackEval 1.3 counts them (Luiten et al. 2021 for HOTA, Ristani et al. 2016 for IDF1, Bernardin and Stiefelhagen 2008
for switches), which compares boxes by overlap. Here a found position is compared with a true one by distance d:
similarity 1 - d / (2 D), at least 0, where D is the objects' diameter. It is 1/2, which is what IDF1 and switches ask
for, where two discs begin to touch; HOTA averages over thresholds from 0.05 (1.9 D) to 0.95 (0.1 D).

TrackEval itself is not installed: it requires `opencv-python`, whose files would overwrite those of
`opencv-python-headless` and which needs a display's libraries to load.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from physpipe.metrics.trackers import distance

Floats = NDArray[np.floating]
THRESHOLDS = np.arange(1, 20) / 20
"""Similarities over which HOTA is averaged."""
TOUCHING = 0.5
"""Similarity from which a track is on an object, for IDF1 and switches."""
EPSILON = np.finfo(float).eps


class Tracked(NamedTuple):
    """One clip: what was found, what is true, and what the tracker itself calls doubtful."""

    found: Floats
    """(T, K, 2) pixels, NaN where lost; K need not be M, and a number is an identity."""
    truth: Floats
    """(T, M, 2) pixels, NaN where not visible."""
    flagged: NDArray[np.bool_]
    """(T, K) where the tracker says that it may have mistaken one object for another."""

    def frames(self, which: NDArray[np.bool_] | slice) -> "Tracked":
        """Some of its frames."""
        return Tracked(self.found[which], self.truth[which], self.flagged[which])


class Counts(NamedTuple):
    """What adds up over clips."""

    hits: Floats
    """(19,) true positions found, a threshold each."""
    association: Floats
    """(19,) sum over those of the share of both identities' frames that they have in common."""
    identity_hits: int
    """True positions found by the one track that is given to their object for the whole clip."""
    true: int
    """True positions."""
    found: int
    """Found positions."""
    switches: int
    """Times that an object goes on with another track than it had."""


def identity_figures(clips: Sequence[Tracked], diameter_px: float) -> dict[str, float | int]:
    """Of clips with several objects: `hota`, `idf1`, `id_switches` (total), `idf1_unflagged`, `flagged`.

    Frames in which some true object is not visible are left out: nobody can say whose a track there is. A track too
    many or one too few lowers HOTA and IDF1.

    For `idf1_unflagged` a frame counts as flagged when any track is flagged in it. Flagged frames are left out and
    every stretch between them is scored as a clip of its own, so that identities need to hold only within it.
    `flagged` is the share of frames so left out: a tracker that doubts everything is never wrong. NaN without a clip,
    `idf1_unflagged` also when all is flagged.
    """
    judged = [clip.frames(np.logical_and.reduce(_seen(clip.truth), axis=1)) for clip in clips]
    frames = sum(len(clip.truth) for clip in judged)
    if not frames:
        return dict.fromkeys(["hota", "idf1", "id_switches", "idf1_unflagged", "flagged"], np.nan)
    whole = _total([count(clip, diameter_px) for clip in judged])
    flagged = sum(int(clip.flagged.any(axis=1).sum()) for clip in judged)
    pieces = [count(piece, diameter_px) for clip in judged for piece in unflagged_stretches(clip)]
    return {
        "hota": hota(whole),
        "idf1": idf1(whole),
        "id_switches": whole.switches,
        "idf1_unflagged": idf1(_total(pieces)) if pieces else np.nan,
        "flagged": flagged / frames,
    }


def similarity(found: Floats, truth: Floats, diameter_px: float) -> Floats:
    """(T, M, K) similarity in [0, 1] of `found` (T, K, 2) and `truth` (T, M, 2), 0 where either is not seen."""
    apart = distance(found[:, None], truth[:, :, None]).astype(np.float64)
    return np.nan_to_num(np.clip(1 - apart / (2 * diameter_px), 0, 1))


def count(clip: Tracked, diameter_px: float) -> Counts:
    """The counts of one clip in which every true object is visible throughout."""
    alike = similarity(clip.found, clip.truth, diameter_px)
    seen = _seen(clip.found)
    hits, association = _associations(alike, seen)
    together = (alike >= TOUCHING).sum(axis=0)
    objects, tracks = linear_sum_assignment(together, maximize=True)
    T, M = clip.truth.shape[:2]
    return Counts(
        hits, association, int(together[objects, tracks].sum()), T * M, int(seen.sum()), _switches(alike, seen)
    )


def hota(counts: Counts) -> float:
    """Higher-order tracking accuracy in [0, 1]: geometric mean of detection and association, averaged."""
    detection = counts.hits / np.maximum(1, counts.true + counts.found - counts.hits)
    return float(np.sqrt(detection * counts.association / np.maximum(1, counts.hits)).mean())


def idf1(counts: Counts) -> float:
    """Share in [0, 1] of true and found positions that agree in place and in identity."""
    return 2 * counts.identity_hits / max(1, counts.true + counts.found)


def unflagged_stretches(clip: Tracked) -> list[Tracked]:
    """The clip cut at its flagged frames, which belong to no stretch."""
    sure = ~clip.flagged.any(axis=1)
    edges = np.flatnonzero(np.diff(sure.astype(np.int8), prepend=0, append=0))
    return [clip.frames(slice(start, stop)) for start, stop in edges.reshape(-1, 2)]


def _seen(xy: Floats) -> NDArray[np.bool_]:
    return np.logical_and.reduce(np.isfinite(xy), axis=-1)


def _total(every: Sequence[Counts]) -> Counts:
    return Counts(*(sum(parts) for parts in zip(*every, strict=True)))


def _associations(alike: Floats, seen: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """(19,) hits and (19,) association of similarities (T, M, K); frames are matched in favour of lasting pairs."""
    T = len(alike)
    frames_of_track = seen.sum(axis=0)
    either = alike.sum(axis=1, keepdims=True) + alike.sum(axis=2, keepdims=True) - alike
    common = np.divide(alike, either, out=np.zeros_like(alike), where=either > EPSILON).sum(axis=0)
    lasting = common / (T + frames_of_track - common)
    matched = np.zeros_like(alike)
    for frame, each in enumerate(alike):
        objects, tracks = linear_sum_assignment(lasting * each, maximize=True)
        matched[frame, objects, tracks] = each[objects, tracks]
    pairs = (matched >= THRESHOLDS[:, None, None, None] - EPSILON).sum(axis=1)  # (19, M, K)
    shares = pairs / np.maximum(1, T + frames_of_track - pairs)
    return pairs.sum(axis=(1, 2)).astype(float), (pairs * shares).sum(axis=(1, 2))


def _switches(alike: Floats, seen: NDArray[np.bool_]) -> int:
    """Times that an object's track differs from its last one; an object keeps its track while that one touches it."""
    M, K = alike.shape[1:]
    last = previous = np.full(M, -1)
    switches = 0
    for each in alike[seen.any(axis=1)]:  # TrackEval passes over a frame in which nothing was found
        kept = previous[:, None] == np.arange(K)
        score = np.where(each >= TOUCHING - EPSILON, 1000 * kept + each, 0)
        objects, tracks = linear_sum_assignment(score, maximize=True)
        on = score[objects, tracks] > 0
        objects, tracks = objects[on], tracks[on]
        switches += int(((last[objects] >= 0) & (last[objects] != tracks)).sum())
        previous, last = np.full(M, -1), last.copy()
        previous[objects] = last[objects] = tracks
    return switches
