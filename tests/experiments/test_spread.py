"""Figures over seeds."""

from experiments.spread import over_seeds


def test_mean_and_worst_by_hand():
    rows = {
        0: {"mean_px": 1.0, "delta_avg": 0.9, "locked": True, "swaps": None},
        2: {"mean_px": 3.0, "delta_avg": 0.7, "locked": False, "swaps": 0.5},
    }
    spread = over_seeds(rows)
    assert {key: spread[key] for key in rows[0]} == {"mean_px": 2, "delta_avg": 0.8, "locked": False, "swaps": None}
    assert spread["worst"] == {"mean_px": 3, "delta_avg": 0.7, "locked": False, "swaps": None}
    assert spread["per_seed"] == {"0": rows[0], "2": rows[2]}


def test_a_figure_that_a_seed_lacks_is_null_and_no_seed_has_no_figures():
    assert over_seeds({0: {"hota": 1.0}, 1: {}})["hota"] is None
    assert over_seeds({}) == {"worst": {}, "per_seed": {}}
