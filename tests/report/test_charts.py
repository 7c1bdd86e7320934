"""Curves of the page hold the numbers of the metrics, each model in its colour."""

import json

import numpy as np
import pytest

from physpipe.report import colours
from physpipe.report.charts import charts
from physpipe.report.curves import error_distributions


@pytest.fixture(scope="module")
def drawn(bowls) -> dict:
    return json.loads(json.dumps(charts(bowls, [50, 90]), allow_nan=False))


def line(panel: dict, model: str) -> dict:
    (found,) = [each for each in panel["lines"] if each["model"] == model]
    return found


def test_error_by_horizon_has_a_panel_a_supervision(drawn, bowls):
    titles = [panel["title"] for panel in drawn["horizons"]]
    assert titles == ["trained on unsupervised tracks", "trained on true positions"]
    for panel, supervision in zip(drawn["horizons"], ("tracks", "truth"), strict=True):
        table = bowls.horizons[bowls.horizons["supervision"] == supervision]
        assert len(panel["lines"]) == table["predictor"].nunique()
        mine, shown = table[table["predictor"] == "dispnet"], line(panel, "predictor:dispnet")
        np.testing.assert_allclose(shown["x"], mine["frame"])
        np.testing.assert_allclose(shown["y"], mine["error_px"], rtol=6e-4)  # four digits


def test_baselines_are_dashed_and_references_drawn_like_text(drawn):
    panel = drawn["horizons"][0]
    assert line(panel, "predictor:persistence")["dashed"]
    assert line(panel, "predictor:persistence")["colour"] == "var(--ink)"
    assert not line(panel, "predictor:dispnet")["dashed"]
    assert line(panel, "predictor:dispnet")["colour"] == colours.of_predictor("dispnet")


def test_distributions_are_those_of_the_metrics_best_first(drawn, bowls):
    (panel,) = drawn["tracker_errors"]
    table = error_distributions(bowls.tracker_errors)
    assert [each["model"] for each in panel["lines"]] == [
        "tracker:unsupervised",
        "tracker:lucas_kanade",
        "tracker:centre",
    ]
    shares = table[table["tracker"] == "centre"]["share"].astype(float)
    np.testing.assert_allclose(line(panel, "tracker:centre")["y"], shares, rtol=6e-4, atol=1e-6)


def test_every_kind_of_loss_gets_a_panel(drawn):
    assert [panel["title"] for panel in drawn["tracker_learning"]] == ["disc", "entropy of the heat map, nats"]
    assert [panel["title"] for panel in drawn["predictor_learning"]] == ["training loss", "validation loss"]
    assert {each["model"] for each in drawn["predictor_learning"][0]["lines"]} == {
        "predictor:dispnet",
        "predictor:probnet",
    }
    names = {each["name"]: each["dashed"] for each in drawn["predictor_learning"][0]["lines"]}
    assert names["dispnet, truth"]
    assert not names["dispnet, tracks"]


def test_without_truth_only_learning_is_drawn(film):
    assert set(charts(film, [50, 90])) == {"tracker_learning", "predictor_learning"}
