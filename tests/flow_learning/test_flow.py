"""A flow network learns a small world, survives a kill, and is the same network every time."""

import pytest
import torch
from small_flow import params

from physpipe.flow_learning import flow
from physpipe.flow_learning.flow import learn_flow


def learned(tmp_path, steps: int = 6, seed: int = 0):
    torch.manual_seed(seed)
    return learn_flow(params(steps), seed, tmp_path / "training.pt")


def test_errors_fall_below_those_of_no_motion(tmp_path):
    """Held-out pairs of 32 px, one ball that goes up to 6 px: zero flow errs by 3 px inside it on average."""
    _, curve = learned(tmp_path, steps=120)
    assert curve["valid"].iloc[-1] < 0.75 * curve["valid"].iloc[0]
    assert set(curve.columns) == {"step", "train", "outside_px", "inside_px", "valid"}


def test_a_killed_training_goes_on_to_the_same_weights(tmp_path, monkeypatch):
    whole, _ = learned(tmp_path / "whole")

    class Killed(BaseException):
        pass

    steps = iter(range(5))

    def dies(drawn, count, generator, draw=flow.draw_pairs):
        if next(steps, None) is None:
            raise Killed
        return draw(drawn, count, generator)

    with monkeypatch.context() as patch:
        patch.setattr(flow, "draw_pairs", dies)
        with pytest.raises(Killed):
            learned(tmp_path / "killed")
    resumed, _ = learned(tmp_path / "killed")
    for name, value in whole.state_dict().items():
        assert torch.equal(value, resumed.state_dict()[name]), name


def test_another_seed_learns_from_other_pairs_but_is_judged_by_the_same(tmp_path):
    _, one = learned(tmp_path / "one", seed=0)
    torch.manual_seed(0)  # the same first weights
    _, other = learn_flow(params(6), 1, tmp_path / "other.pt")
    assert one["train"].iloc[0] != other["train"].iloc[0]
