"""The tracker's verdict on itself: each figure beside the bound that it must keep."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from physpipe.tracknet.signals import LARGEST, LockParams, keeps

WORDS = {
    "order_accuracy": "orders told apart",
    "siamese_px": "turning error, px",
    "entropy_nats": "entropy of the heat map, nats",
    "motion_share": "share of motion near the detection",
    "extent_px": "extent of a trajectory, px",
}


class Bounded(NamedTuple):
    """One figure of every detector."""

    words: str
    bound: str
    values: list[float | None]
    """By detector; None where the verdict lacks it."""
    missed: list[bool]
    """Whether that value is beyond the bound."""


def verdict(signals: Sequence[Mapping[str, Any]], bounds: LockParams) -> list[Bounded]:
    """The figures that `locked` rests on; `signals` is `objects` of a verdict.json."""
    return [_bounded(key, [each.get(key) for each in signals], bounds) for key in WORDS]


def _bounded(key: str, values: list[float | None], bounds: LockParams) -> Bounded:
    told = f"at {'most' if key in LARGEST else 'least'} {getattr(bounds, key):g}"
    missed = [value is not None and not keeps(key, value, bounds) for value in values]
    return Bounded(WORDS[key], told, values, missed)
