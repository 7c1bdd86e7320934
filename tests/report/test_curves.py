"""Long tables for plots keep what they are made from."""

import numpy as np
import pandas as pd
import pytest

from physpipe.io import results
from physpipe.report.curves import ERROR_GRID_PX, error_distributions, learning_curves


def test_distribution_counts_frames_within_and_never_lost_ones():
    errors = pd.DataFrame({"tracker": "lab", "error_px": [0.01, 1.0, 3.0, np.nan]})
    table = error_distributions(errors).set_index("error_px")["share"]
    assert table.iloc[0] == 0.25
    assert table[table.index < 1].iloc[-1] == 0.25
    assert table[table.index > 1].iloc[0] == 0.5
    assert table.iloc[-1] == 0.75  # one frame in four is lost


def test_distribution_has_one_grid_for_all_trackers():
    errors = pd.DataFrame({"tracker": ["a", "b"], "error_px": [1.0, 50.0]})
    for _, mine in error_distributions(errors).groupby("tracker"):
        np.testing.assert_array_equal(mine["error_px"], ERROR_GRID_PX)


def test_no_errors_give_an_empty_table():
    assert error_distributions(pd.DataFrame(columns=["tracker", "error_px"])).empty


def test_thinned_learning_curve_keeps_both_ends_and_lies_on_the_curve(tmp_path):
    step = np.arange(5000)
    results.save_csv(tmp_path / "curve.csv", pd.DataFrame({"step": step, "train": step * 2.0, "note": "x"}))
    table = learning_curves([("dispnet, tracks", tmp_path / "curve.csv")])
    assert len(table) <= 200
    assert table["step"].iloc[[0, -1]].tolist() == [0, 4999]
    np.testing.assert_array_equal(table["value"], table["step"] * 2.0)
    assert set(table["loss"]) == {"train"}


def test_each_phase_is_a_curve_and_a_repeated_file_adds_nothing(tmp_path):
    curve = pd.DataFrame({"step": [1, 2, 1, 2], "disc": [4.0, 3.0, 2.0, 1.0], "phase": ["start 0"] * 2 + ["rest"] * 2})
    for name in ("first.csv", "all.csv"):
        results.save_csv(tmp_path / name, curve)
    table = learning_curves([("tracker", tmp_path / "first.csv"), ("tracker", tmp_path / "all.csv")])
    assert table["model"].tolist() == ["tracker, start 0"] * 2 + ["tracker, rest"] * 2
    assert table["value"].tolist() == [4.0, 3.0, 2.0, 1.0]


@pytest.mark.parametrize("text", ["", "\n", "step,train\n"])
def test_an_empty_curve_is_no_curve(tmp_path, text):
    (tmp_path / "curve.csv").write_text(text)
    assert learning_curves([("dispnet, tracks", tmp_path / "curve.csv")]).empty
