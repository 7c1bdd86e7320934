import numpy as np
import pandas as pd
import pytest
import torch

from physpipe.core.errors import InputError
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictors import DispNet, Persistence, Quadratic
from physpipe.predictors.dispnet import DispNetParams
from physpipe.predictors.polynomial import NoParams

HORIZON = 6


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
    net = DispNet(DispNetParams(stem=8, channels=8, hidden=8, follow=True, symmetric=True), 1)
    torch.nn.init.normal_(net.change[-1].weight)
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
