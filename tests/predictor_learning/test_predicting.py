import pandas as pd
import pytest
import torch

from physpipe.core.errors import InputError
from physpipe.io import checkpoints
from physpipe.learning.training import FitParams
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictor_learning.predicting import (
    WEIGHTS,
    learn_predictor,
    load_predictor,
    predictor_class,
    save_predictor,
)
from physpipe.predictor_learning.windows import WindowParams
from physpipe.predictors.dispnet import DispNetParams

HORIZON = 6
MODEL = DispNetParams(stem=8, channels=8, hidden=8, follow=True, symmetric=True)
FIT = FitParams(
    steps=6, batch_size=4, learning_rate=3e-3, final_rate=0.1, warmup_steps=1, weight_decay=1e-2, clip_norm=1.0,
    valid_every=2, patience=9, precision="bfloat16",
)  # fmt: skip
WINDOWS = WindowParams(noise_px=0.1, first_share=0.25, valid_windows=6)


def learn(found, table, checkpoint):
    torch.manual_seed(0)
    return learn_predictor("dispnet", (MODEL, FIT, WINDOWS), found, table, HORIZON, 1, checkpoint)


def test_a_killed_training_of_dispnet_ends_with_bit_identical_weights(tmp_path, monkeypatch, falling_balls):
    found, table = falling_balls()
    whole, curve = learn(found, table, tmp_path / "whole.pt")
    kind, calls = predictor_class("dispnet"), []

    def killed(self, batch, generator):
        calls.append(1)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return super(kind, self).loss(batch, generator)

    with monkeypatch.context() as patch:
        patch.setattr(kind, "loss", killed)
        with pytest.raises(KeyboardInterrupt):
            learn(found, table, tmp_path / "killed.pt")
    resumed, resumed_curve = learn(found, table, tmp_path / "killed.pt")
    assert all(torch.equal(whole.state_dict()[name], each) for name, each in resumed.state_dict().items())
    assert resumed_curve.equals(curve)


def test_a_saved_predictor_forecasts_as_before(tmp_path, falling_balls):
    found, table = falling_balls()
    made, curve = learn(found, table, tmp_path / "c.pt")
    save_predictor(tmp_path / "model", "dispnet", made, MODEL, curve)
    before = forecast(made, found, table, "test", HORIZON, "dispnet").table
    loaded = load_predictor(tmp_path / "model", "dispnet", objects=1)
    pd.testing.assert_frame_equal(forecast(loaded, found, table, "test", HORIZON, "dispnet").table, before)
    assert pd.read_csv(tmp_path / "model" / "curve.csv")["step"].tolist() == [2, 4, 6]


@pytest.fixture
def saved(tmp_path):
    predictor = predictor_class("dispnet")(MODEL, 1)
    save_predictor(tmp_path / "model", "dispnet", predictor, MODEL, pd.DataFrame())
    return tmp_path / "model"


def test_tracks_of_another_number_of_objects_are_refused(saved):
    with pytest.raises(InputError, match="learned 1 objects; the tracks have 2"):
        load_predictor(saved, "dispnet", objects=2)


def test_weights_of_another_shape_or_kind_are_refused(saved):
    content = checkpoints.load(saved / WEIGHTS)
    for key, value, reason in (
        ("params", MODEL.model_copy(update={"channels": 16}).model_dump(), "weights of another model"),
        ("params", {"width": 3}, "params of another model"),
        ("predictor", "probnet", "not `dispnet`"),
    ):
        checkpoints.save(saved / WEIGHTS, {**content, key: value})
        with pytest.raises(InputError, match=reason):
            load_predictor(saved, "dispnet", objects=1)


def test_an_unknown_predictor_is_refused():
    with pytest.raises(InputError, match="use one of persistence"):
        predictor_class("crystal_ball")
