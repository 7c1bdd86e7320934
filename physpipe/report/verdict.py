"""The tracker's verdict on itself: each figure beside the bound that it must keep."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from physpipe.tracknet.signals import LockParams

WORDS = {
    "order_accuracy": "orders told apart",
    "siamese_px": "turning error, px",
    "entropy_nats": "entropy of the heat map, nats",
    "motion_share": "share of motion near the detection",
    "extent_px": "extent of a trajectory, px",
}
LARGEST = ("siamese_px", "entropy_nats")
"""Figures whose bound is the largest that locks; the others' is the smallest."""


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
    return [_bounded(key, [each.get(key) for each in signals], getattr(bounds, key)) for key in WORDS]


def _bounded(key: str, values: list[float | None], bound: float) -> Bounded:
    largest = key in LARGEST
    missed = [value is not None and (value > bound if largest else value < bound) for value in values]
    return Bounded(WORDS[key], f"at {'most' if largest else 'least'} {bound:g}", values, missed)
