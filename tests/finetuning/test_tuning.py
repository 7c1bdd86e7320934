"""Tuned together, tracker and predictor come closer; what got worse in anything known without labels is not shipped."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from springs import STATE
from torch import nn

from physpipe.core.errors import InputError
from physpipe.finetuning import tuning
from physpipe.finetuning.joint import AgreementParams
from physpipe.finetuning.saving import PREDICTOR, VERDICT, save_tuned
from physpipe.finetuning.tuning import FinetuneParams, State, gained, tune
from physpipe.io import results
from physpipe.learning.training import FitParams
from physpipe.predictor_learning.predicting import CURVE, LearnedParams, load_predictor
from physpipe.predictor_learning.windows import WindowParams
from physpipe.predictors import PREDICTORS
from physpipe.predictors.interpnet import InterpNetParams
from physpipe.predictors.probnet import ProbNetParams
from physpipe.predictors.tensor_state import TensorStateParams
from physpipe.predictors.terrain_params import TerrainParams
from physpipe.trackers import detectors

WINDOWS = WindowParams(noise_px=0, first_share=0.2, valid_windows=8)
FIT = FitParams(
    steps=24, batch_size=4, learning_rate=2e-3, final_rate=0.5, warmup_steps=2, weight_decay=0, clip_norm=1,
    valid_every=4, patience=100, precision="float32",
)  # fmt: skip
PARAMS = FinetuneParams(
    agreement=AgreementParams(looks=2, window_px=6, consistency=0.3, prior=0.05, prior_px=4), held_out=8, fit=FIT
)
SMALL = TensorStateParams(**STATE | {"symmetric": False})
SHORT = FIT.model_copy(update={"steps": 2, "valid_every": 2})
KINDS = {
    "probnet": ProbNetParams(**STATE, least_std_px=0.25, largest_std_px=40.0, distance_steps=0),
    "interpnet": InterpNetParams(**STATE, first_state=1.0),
    "terrain": TerrainParams(
        channels=16, hidden=8, code=2, matched_steps=0, matched_weight_s2=1, stretches=2, smoothing_s=0.06,
        spread_rounds=4, symmetric=False,
    ),
}  # fmt: skip
BEFORE = State(unlocked=False, score=0.3, tracker_px=0.5, forecast_px=2.0, forecast_loss=-1.0)


def tuned(pair, checkpoint, params=PARAMS, nets=None):
    return tune(
        pair.clips,
        pair.table,
        nets or [pair.net],
        pair.predictor,
        8,
        True,
        pair.tracker,
        WINDOWS,
        params,
        0,
        checkpoint,
    )


def same(one: nn.Module, other: nn.Module) -> bool:
    return all(torch.equal(value, other.state_dict()[name]) for name, value in one.state_dict().items())


@pytest.mark.parametrize(
    "worse",
    [
        {"unlocked": True},
        {"score": 0.31},
        {"tracker_px": 0.51},
        {"forecast_px": 2.1},
        {"forecast_loss": -0.9},
        {"score": float("nan")},
    ],
)
def test_one_figure_that_got_worse_is_enough_to_ship_nothing(worse):
    better = replace(BEFORE, score=0.2, tracker_px=0.4, forecast_px=1.0, forecast_loss=-2.0)
    assert gained(better, BEFORE)
    assert not gained(replace(better, **worse), BEFORE)


def test_what_did_not_change_gained_nothing_and_what_never_locked_is_not_shipped():
    assert not gained(BEFORE, BEFORE)
    unlocked = replace(BEFORE, unlocked=True)
    assert not gained(replace(unlocked, score=0.1), unlocked)


def test_a_pair_that_gains_is_shipped_better_in_what_is_known_and_the_former_one_is_left_as_it_was(pair, tmp_path):
    former = {name: value.clone() for name, value in pair.net.state_dict().items()}
    found = tuned(pair, tmp_path / "c.pt")
    assert found.gained, (found.before, found.after)
    assert found.after.forecast_px < found.before.forecast_px  # pixels; the predictor had learned nothing
    assert found.after.tracker_px <= found.before.tracker_px
    assert found.after.score <= found.before.score
    assert not same(found.predictor, pair.predictor)
    assert all(torch.equal(value, former[name]) for name, value in pair.net.state_dict().items())


def test_a_pair_that_got_worse_is_replaced_by_the_former_two(pair, tmp_path, monkeypatch):
    monkeypatch.setattr(tuning, "gained", lambda after, before: False)
    found = tuned(pair, tmp_path / "c.pt")
    assert not found.gained
    assert same(found.net, pair.net)
    assert same(found.predictor, pair.predictor)


def test_the_same_seed_tunes_alike_and_a_killed_tuning_goes_on(pair, tmp_path, monkeypatch):
    whole = tuned(pair, tmp_path / "whole.pt")
    calls = []

    def until(joint, task, held_out, state=tuning._state):
        calls.append(1)
        if len(calls) == 4:  # before the training, at steps 4, 8 and 12
            raise KeyboardInterrupt
        return state(joint, task, held_out)

    monkeypatch.setattr(tuning, "_state", until)
    with pytest.raises(KeyboardInterrupt):
        tuned(pair, tmp_path / "killed.pt")
    monkeypatch.undo()
    again = tuned(pair, tmp_path / "killed.pt")
    assert (again.before, again.after) == (whole.before, whole.after)
    assert same(again.net, whole.net)
    assert same(again.predictor, whole.predictor)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_predictor_is_tuned(pair, tmp_path, kind):
    torch.manual_seed(0)
    untuned = PREDICTORS[kind](KINDS[kind], 1).eval()
    found = tuned(replace(pair, predictor=untuned), tmp_path / "c.pt", PARAMS.model_copy(update={"fit": SHORT}))
    assert np.isfinite([found.after.forecast_px, found.after.forecast_loss, found.after.tracker_px]).all()
    assert list(found.curve["step"]) == [2]


def test_detectors_of_one_object_each_are_refused(pair, tmp_path):
    with pytest.raises(InputError, match=r"2 detectors, each learned.*use `tracker.recipe: joint`"):
        tuned(pair, tmp_path / "c.pt", nets=[pair.net, pair.net])


def test_what_is_saved_tracks_and_forecasts_again_and_says_whether_it_gained(pair, tmp_path):
    found = tuned(pair, tmp_path / "c.pt")
    made = {"kind": "dispnet", "trained_to": "horizon", "model": SMALL, "windows": WINDOWS, "fit": FIT}
    save_tuned(tmp_path / "out", found, "dispnet", LearnedParams[TensorStateParams](**made))
    (net,) = detectors.load(tmp_path / "out" / detectors.WEIGHTS)
    assert same(net, found.net)
    assert same(load_predictor(tmp_path / "out" / PREDICTOR, "dispnet", 1), found.predictor)
    verdict = results.load_json(tmp_path / "out" / VERDICT)
    assert verdict["gained"] is found.gained
    assert verdict["tracks"] == 1
    assert (tmp_path / "out" / CURVE).read_text().count("\n") == 1 + len(found.curve)
    assert verdict["score"] == pytest.approx((found.after if found.gained else found.before).score, abs=1e-6)
    assert verdict["before"]["tracker_px"] == pytest.approx(found.before.tracker_px)
