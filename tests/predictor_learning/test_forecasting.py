import numpy as np
import pandas as pd
import pytest
import torch

from physpipe.core.errors import InputError
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictors import DispNet, InterpNet, Persistence, ProbNet, Quadratic
from physpipe.predictors.interpnet import InterpNetParams
from physpipe.predictors.polynomial import NoParams
from physpipe.predictors.probnet import ProbNetParams
from physpipe.predictors.tensor_state import TensorStateParams

HORIZON, END = 6, 12
STATE = {"stem": 8, "channels": 8, "hidden": 8, "follow": True, "symmetric": True, "objects_alike": True}


def interpnet():
    torch.manual_seed(0)
    net = InterpNet(InterpNetParams(**STATE, first_state=1.0), 1)
    torch.nn.init.normal_(net.law[-1].weight)
    return net


def test_forecasts_run_from_the_first_unseen_frame_to_four_horizons_or_the_clips_end(falling_balls):
    found, table = falling_balls()
    made = forecast(Quadratic(NoParams(), 1), found, table, "test", HORIZON, "quadratic")
    spans = made.table.groupby("clip")["frame"].agg(["min", "max"])
    assert spans.to_numpy().tolist() == [[10, 4 * HORIZON], [10, 19]]
    assert made.skipped == 0


def test_forecasts_of_free_fall_are_exact(falling_balls):
    found, table = falling_balls(objects=2)
    made = forecast(Quadratic(NoParams(), 2), found, table, "test", HORIZON, "quadratic").table
    both = made.merge(table, on=["clip", "object", "frame"], suffixes=("", "_true"))
    assert len(both) == len(made)
    assert (both[["x", "y"]].to_numpy() - both[["x_true", "y_true"]].to_numpy()).max() < 1e-3  # px


def test_a_forecast_ignores_everything_after_the_seen_frames(falling_balls):
    found, table = falling_balls()
    torch.manual_seed(0)
    net = DispNet(TensorStateParams(**STATE), 1)
    torch.nn.init.normal_(net.law[-1].weight)
    before = forecast(net, found, table, "test", HORIZON, "dispnet").table
    later = table["frame"] >= net.seen_frames
    for name in found.names("test"):
        film = np.array(found.frames(name))
        film[net.seen_frames :] = 255 - film[net.seen_frames :]
        np.save(found.folder / f"{name}.npy", film)
    changed = table.assign(x=table["x"].where(~later, 7), y=table["y"].where(~later, np.float32(9)))
    pd.testing.assert_frame_equal(forecast(net, found, changed, "test", HORIZON, "dispnet").table, before)


def test_clips_lost_or_too_short_at_their_start_are_left_out_and_counted(falling_balls):
    found, table = falling_balls(lengths=(16, 16, 16, 30, 3))
    assert forecast(Persistence(NoParams(), 1), found, table, "test", HORIZON, "p").skipped == 1
    lost = (table["clip"] == "c3") & (table["frame"] == 2)
    table = table.assign(x=table["x"].mask(lost), y=table["y"].mask(lost))
    made = forecast(Persistence(NoParams(), 1), found, table, "test", HORIZON, "p")
    assert (made.skipped, len(made.table)) == (2, 0)


def test_a_horizon_beyond_every_clip_is_an_input_error(falling_balls):
    found, table = falling_balls()
    with pytest.raises(InputError, match="no test clip reaches frame 30"):
        forecast(Persistence(NoParams(), 1), found, table, "test", 30, "p")


def test_test_clips_without_tracks_are_an_input_error(falling_balls):
    found, table = falling_balls()
    with pytest.raises(InputError, match="no tracks of clip c4"):
        forecast(Persistence(NoParams(), 1), found, table[table["clip"] != "c4"], "test", HORIZON, "p")


def test_a_predictor_that_sees_the_end_forecasts_up_to_it_from_that_frame_and_no_position_there(falling_balls):
    found, table = falling_balls(lengths=(16, 16, 16, 30, 20))
    net = interpnet()
    before = forecast(net, found, table, "test", HORIZON, "interpnet", END).table
    assert before.groupby("clip")["frame"].agg(["min", "max"]).to_numpy().tolist() == [[4, END], [4, END]]
    changed = table.assign(x=table["x"].where(table["frame"] < 4, 7))
    pd.testing.assert_frame_equal(forecast(net, found, changed, "test", HORIZON, "interpnet", END).table, before)
    for frame, same in ((5, True), (END, False)):
        for name in found.names("test"):
            film = np.array(found.frames(name))
            film[frame] = 255 - film[frame]
            np.save(found.folder / f"{name}.npy", film)
        assert forecast(net, found, table, "test", HORIZON, "interpnet", END).table.equals(before) == same


def test_clips_that_end_before_the_frame_to_be_seen_are_left_out_and_counted(falling_balls):
    found, table = falling_balls(lengths=(16, 16, 16, 30, END))
    made = forecast(interpnet(), found, table, "test", HORIZON, "interpnet", END)
    assert (made.skipped, made.table["clip"].unique().tolist()) == (1, ["c3"])
    with pytest.raises(InputError, match="no test clip reaches frame 30"):
        forecast(interpnet(), found, table, "test", HORIZON, "interpnet", 30)


def test_covariances_come_with_the_forecasts_that_have_them(falling_balls):
    found, table = falling_balls()
    net = ProbNet(ProbNetParams(**STATE, least_std_px=0.25, largest_std_px=40.0, distance_steps=0), 1)
    made = forecast(net, found, table, "test", HORIZON, "probnet").table
    assert np.isfinite(made[["cov_xx", "cov_xy", "cov_yy"]]).all(axis=None)
