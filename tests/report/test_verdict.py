"""The page says of each figure of the verdict whether it kept its bound, as the tracker judged."""

from dataclasses import asdict, replace

import pytest

from physpipe.report.verdict import WORDS, verdict
from physpipe.tracknet.signals import LockParams, Signals, locked

BOUNDS = LockParams(order_accuracy=0.8, siamese_px=3.0, entropy_nats=3.0, motion_share=0.3, extent_px=0.5)
KEPT = Signals(
    order_nats=0.2, order_accuracy=0.8, siamese_px=3.0, entropy_nats=3.0, motion_share=0.3, extent_px=0.5
)  # exactly at every bound
BEYOND = {"order_accuracy": 0.79, "siamese_px": 3.1, "entropy_nats": 3.1, "motion_share": 0.29, "extent_px": 0.49}


def test_every_bound_has_words_and_is_told():
    assert set(WORDS) == set(LockParams.model_fields) == set(BEYOND)
    told = {line.words: line.bound for line in verdict([asdict(KEPT)], BOUNDS)}
    assert told["orders told apart"] == "at least 0.8"
    assert told["turning error, px"] == "at most 3"


def test_at_its_bound_a_figure_is_kept():
    assert locked(KEPT, BOUNDS)
    assert [line.missed for line in verdict([asdict(KEPT)], BOUNDS)] == [[False]] * 5


@pytest.mark.parametrize("key", BEYOND)
def test_the_one_figure_beyond_its_bound_is_the_one_that_is_named(key):
    off = replace(KEPT, **{key: BEYOND[key]})
    assert not locked(off, BOUNDS)
    lines = {line.words: line for line in verdict([asdict(KEPT), asdict(off)], BOUNDS)}
    assert {words: line.missed for words, line in lines.items() if any(line.missed)} == {WORDS[key]: [False, True]}
    assert lines[WORDS[key]].values[1] == BEYOND[key]


def test_a_figure_that_is_not_known_is_not_missed():
    assert all(line.values == [None] and line.missed == [False] for line in verdict([{}], BOUNDS))
