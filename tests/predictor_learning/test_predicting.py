import numpy as np
import pandas as pd
import pytest
import torch
import yaml

from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.io import checkpoints
from physpipe.learning.training import FitParams
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictor_learning.predicting import (
    WEIGHTS,
    learn_predictor,
    learned_params,
    load_predictor,
    predictor_class,
    save_predictor,
)
from physpipe.predictor_learning.windows import TrackWindows, WindowParams
from physpipe.predictors.interpnet import InterpNetParams
from physpipe.predictors.probnet import ProbNetParams
from physpipe.predictors.tensor_state import TensorStateParams
from physpipe.predictors.terrain_params import TerrainParams

HORIZON, END = 6, 9
STATE = {"stem": 8, "channels": 8, "hidden": 8, "follow": True, "symmetric": True, "objects_alike": True}
MODELS = {
    "posnet": TensorStateParams(**STATE),
    "dispnet": TensorStateParams(**STATE),
    "probnet": ProbNetParams(**STATE, least_std_px=0.25, largest_std_px=40.0, distance_steps=3),
    "interpnet": InterpNetParams(**STATE, first_state=1.0),
    "terrain": TerrainParams(
        channels=16, hidden=8, code=2, matched_steps=3, matched_weight_s2=1, stretches=2, smoothing_s=0.06,
        spread_rounds=4, symmetric=True,
    ),
}  # fmt: skip
FIT = FitParams(
    steps=6, batch_size=4, learning_rate=3e-3, final_rate=0.1, warmup_steps=1, weight_decay=1e-2, clip_norm=1.0,
    valid_every=2, patience=9, precision="bfloat16",
)  # fmt: skip
WINDOWS = WindowParams(noise_px=0.1, first_share=0.25, valid_windows=6)


def params_of(kind):
    section = {"kind": kind, "trained_to": "horizon", "model": MODELS[kind], "windows": WINDOWS, "fit": FIT}
    return learned_params(predictor_class(kind))(**section)


def learn(kind, found, table, checkpoint, last_frame=HORIZON):
    torch.manual_seed(0)
    return learn_predictor(f"{kind}_x", params_of(kind), found, table, last_frame, True, 1, checkpoint)


@pytest.mark.parametrize("name", MODELS)
def test_a_killed_training_ends_with_bit_identical_weights(tmp_path, monkeypatch, falling_balls, name):
    found, table = falling_balls()
    whole, curve = learn(name, found, table, tmp_path / "whole.pt")
    kind, calls = predictor_class(name), []
    loss = kind.loss

    def killed(self, batch, generator):
        calls.append(1)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return loss(self, batch, generator)

    with monkeypatch.context() as patch:
        patch.setattr(kind, "loss", killed)
        with pytest.raises(KeyboardInterrupt):
            learn(name, found, table, tmp_path / "killed.pt")
    resumed, resumed_curve = learn(name, found, table, tmp_path / "killed.pt")
    assert all(torch.equal(whole.state_dict()[name], each) for name, each in resumed.state_dict().items())
    assert resumed_curve.equals(curve)


@pytest.mark.parametrize("name", MODELS)
def test_a_saved_predictor_forecasts_as_before(tmp_path, falling_balls, name):
    found, table = falling_balls()
    made, curve = learn(name, found, table, tmp_path / "c.pt", END)
    save_predictor(tmp_path / "model", f"{name}_x", made, params_of(name), curve)
    before = forecast(made, found, table, "test", HORIZON, name, END).table
    loaded = load_predictor(tmp_path / "model", f"{name}_x", objects=1)
    pd.testing.assert_frame_equal(forecast(loaded, found, table, "test", HORIZON, name, END).table, before)
    assert pd.read_csv(tmp_path / "model" / "curve.csv")["step"].tolist() == [2, 4, 6]


@pytest.mark.parametrize("name", MODELS)
def test_clips_too_short_for_the_training_are_an_input_error(tmp_path, falling_balls, name):
    found, table = falling_balls()
    with pytest.raises(InputError, match=r"no train clip has 17 consecutive frames.*`predict.interpolation`"):
        learn(name, found, table, tmp_path / "c.pt", last_frame=16)


@pytest.mark.parametrize(("last_frame", "judged_to"), [(4, 8), (8, 8)])
def test_how_sure_to_be_is_judged_twice_as_far_ahead_where_clips_are_as_long(
    tmp_path, monkeypatch, falling_balls, last_frame, judged_to
):
    told = []
    monkeypatch.setattr(predictor_class("dispnet"), "calibrate", lambda self, held_out: told.append(held_out))
    learn("dispnet", *falling_balls(), tmp_path / "c.pt", last_frame)
    assert [window.asked_times[0, -1].item() for window in told] == [judged_to]


def test_how_sure_to_be_is_judged_by_the_windows_that_begin_soonest(tmp_path, monkeypatch, falling_balls):
    told = []
    monkeypatch.setattr(TrackWindows, "early", lambda self, count: told.append(count) or np.array([0]))
    learn("dispnet", *falling_balls(), tmp_path / "c.pt")
    assert told == [params_of("dispnet").windows.valid_windows]


def test_windows_with_a_lost_object_are_counted_and_never_learned_from(tmp_path, falling_balls, capsys):
    found, table = falling_balls()
    lost = (table["clip"] == "c0") & (table["frame"] == 8)
    table = table.assign(x=table["x"].mask(lost), y=table["y"].mask(lost))
    _, curve = learn("dispnet", found, table, tmp_path / "c.pt")
    assert "13 windows to learn from; 7 left out" in capsys.readouterr().out
    assert curve.notna().all(axis=None)


@pytest.fixture
def saved(tmp_path):
    predictor = predictor_class("dispnet")(MODELS["dispnet"], 1)
    save_predictor(tmp_path / "model", "dispnet_x", predictor, params_of("dispnet"), pd.DataFrame())
    return tmp_path / "model"


def test_tracks_of_another_number_of_objects_are_refused(saved):
    with pytest.raises(InputError, match="learned 1 objects; the tracks have 2"):
        load_predictor(saved, "dispnet_x", objects=2)


def test_weights_of_another_shape_or_kind_are_refused(saved):
    content = checkpoints.load(saved / WEIGHTS)
    for key, value, reason in (
        ("params", MODELS["dispnet"].model_copy(update={"channels": 16}).model_dump(), "weights of another model"),
        ("params", {"width": 3}, "params of another model"),
        ("kind", "probnet", "params of another model"),
        ("kind", "crystal_ball", "no such kind"),
        ("predictor", "probnet", "not `dispnet_x`"),
    ):
        checkpoints.save(saved / WEIGHTS, {**content, key: value})
        with pytest.raises(InputError, match=reason):
            load_predictor(saved, "dispnet_x", objects=1)


def test_an_unknown_kind_is_refused():
    with pytest.raises(InputError, match="use one of persistence"):
        predictor_class("crystal_ball")


def test_a_misspelt_key_of_a_model_is_named_with_the_nearest_one(tmp_path):
    path = tmp_path / "params.yaml"
    section = params_of("dispnet").model_dump()
    section["model"]["chanels"] = section["model"].pop("channels")
    path.write_text(yaml.safe_dump({"predictors": {"mine": section}}))
    with pytest.raises(InputError, match=r"`predictors\.mine\.model\.chanels`.*did you mean `channels`"):
        read("predictors.mine", learned_params(predictor_class("dispnet")), path)
