"""Starts and checkpoints are chosen without labels, and one that is not locked never before one that is."""

from dataclasses import replace

import pytest
from torch import nn

from physpipe.tracker_learning.lesson import Lesson
from physpipe.tracknet.signals import LockParams, SignalParams, Signals

SCORED = SignalParams(noise_px=0.5, batches=1, siamese_weight=0.1, near_px=8.0)
BOUNDS = LockParams(order_accuracy=0.8, siamese_px=3.0, entropy_nats=3.0, motion_share=0.3, extent_px=0.5)
FOLLOWS = Signals(order_nats=0.3, order_accuracy=0.9, siamese_px=1.0, entropy_nats=2.0, motion_share=0.6, extent_px=3.0)


class Told(Lesson):
    """Reads off a network what it was made to carry."""

    def read(self, net: nn.Module) -> Signals:
        return net.signals


def carrying(signals: Signals) -> nn.Module:
    net = nn.Module()
    net.signals = signals
    return net


@pytest.fixture
def task() -> Lesson:
    return Told(train=None, held_out=[], signals=SCORED, lock=BOUNDS)


@pytest.mark.parametrize("away", [{"motion_share": 0.0}, {"extent_px": 0.0}, {"entropy_nats": 6.9}])
def test_a_better_score_on_the_wrong_thing_loses(task, away):
    follows, wrong = carrying(FOLLOWS), carrying(replace(FOLLOWS, order_nats=0.05, **away))
    assert wrong.signals.score(SCORED) < follows.signals.score(SCORED)
    assert min([wrong, follows], key=task.rank) is follows


@pytest.mark.parametrize("extent_px", [3.0, 0.0])
def test_among_those_locked_alike_the_score_decides(task, extent_px):
    one = carrying(replace(FOLLOWS, extent_px=extent_px))
    worse = carrying(replace(FOLLOWS, extent_px=extent_px, siamese_px=2.0))
    assert min([worse, one], key=task.rank) is one


def test_a_score_of_the_order_and_the_turning_error(task):
    assert task.rank(carrying(FOLLOWS)) == (False, pytest.approx(0.3 + 0.1 * 1.0))
