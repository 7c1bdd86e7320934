"""The coverage chart tells how much the ellipses hold, beside what they claim to."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from physpipe.io import forecasts, tracks
from physpipe.metrics.predictors import covered, squared_mahalanobis
from physpipe.report import colours
from physpipe.report.charts import charts
from physpipe.report.coverage import coverage, shares_inside

PERCENT = [10, 25, 50, 75, 90, 95]
CLIPS, OBJECTS, SEEN, HORIZON = 60, 50, 4, 5
COV = np.array([[9.0, 2.0], [2.0, 4.0]])


@pytest.fixture(scope="module")
def sampled(bowls):
    """Evidence in which the truth is drawn from the forecast of `probnet`; `dispnet` claims half that spread."""
    names = [f"clip_{number:04d}" for number in range(CLIPS)]
    last = 2 * HORIZON
    drawn = np.random.default_rng(0).multivariate_normal([30, 20], COV, (CLIPS, last + 1, OBJECTS))
    times = np.arange(last + 1) / 10
    ones = np.ones((last + 1, OBJECTS))
    truth = pd.concat([tracks.rows(name, times, xy, ones) for name, xy in zip(names, drawn, strict=True)])
    mean = np.full((last + 1 - SEEN, OBJECTS, 2), [30.0, 20.0])

    def forecast(cov: np.ndarray | None) -> pd.DataFrame:
        spread = None if cov is None else np.broadcast_to(cov, (*mean.shape, 2))
        one = forecasts.rows("", SEEN, mean, spread)
        return pd.concat([one.assign(clip=name) for name in names])

    made = {"probnet": forecast(COV), "dispnet": forecast(COV / 4), "linear": forecast(None)}
    return replace(bowls, truth=truth, forecasts=made, horizon=HORIZON)


@pytest.fixture(scope="module")
def shares(sampled) -> pd.DataFrame:
    return coverage(sampled, PERCENT)


def test_exact_samples_lie_on_the_diagonal(shares):
    for at in ("T", "2T"):
        mine = shares[(shares["predictor"] == "probnet") & (shares["at"] == at)]
        assert mine["percent"].tolist() == PERCENT
        assert (mine["positions"] == CLIPS * OBJECTS).all()
        np.testing.assert_allclose(mine["share"], np.array(PERCENT) / 100, atol=0.02)


def test_who_is_too_sure_lies_below_it(shares):
    mine = shares[(shares["predictor"] == "dispnet") & (shares["at"] == "T")]
    expected = 1 - (1 - np.array(PERCENT) / 100) ** 0.25  # a quarter of the squared radius
    np.testing.assert_allclose(mine["share"], expected, atol=0.02)


def test_only_predictors_with_covariances_are_told(shares):
    assert set(shares["predictor"]) == {"probnet", "dispnet"}


def test_shares_are_those_of_the_scores():
    rng = np.random.default_rng(1)
    missed, cov = rng.normal(0, 3, (200, 2)), np.broadcast_to(COV, (200, 2, 2))
    squared = squared_mahalanobis(np.zeros((200, 2)), cov, missed)
    ours = shares_inside(squared, np.array(PERCENT, float))
    theirs = [covered(np.zeros((1, 200, 2)), cov[None], missed[None], level / 100).mean() for level in PERCENT]
    np.testing.assert_allclose(ours, theirs)


def test_the_chart_has_a_panel_a_time_and_what_is_claimed(sampled, shares):
    panels = json.loads(json.dumps(charts(sampled, PERCENT), allow_nan=False))["coverage"]
    assert [panel["title"] for panel in panels] == ["at T = 5", "at 2T = 10"]
    for panel, at in zip(panels, ("T", "2T"), strict=True):
        *ours, claimed = panel["lines"]
        assert [each["model"] for each in ours] == ["predictor:probnet", "predictor:dispnet"]
        assert [each["colour"] for each in ours] == [colours.of_predictor(name) for name in ("probnet", "dispnet")]
        assert ours[0]["name"] == f"probnet, n = {CLIPS * OBJECTS}"
        mine = shares[(shares["predictor"] == "probnet") & (shares["at"] == at)]
        assert ours[0]["x"] == PERCENT
        np.testing.assert_allclose(ours[0]["y"], mine["share"], rtol=6e-4)  # four digits
        assert (claimed["model"], claimed["dashed"]) == ("", True)
        assert claimed["x"] == [0, *PERCENT, 100]
        np.testing.assert_allclose(np.array(claimed["y"]) * 100, claimed["x"])


def test_without_covariances_or_truth_there_is_no_chart(sampled, bowls, film):
    sure = replace(bowls, forecasts={"linear": bowls.forecasts["linear"]})
    assert "coverage" not in charts(sure, PERCENT)
    assert "coverage" not in charts(film, PERCENT)
    short = replace(sampled, forecasts={"probnet": sampled.forecasts["probnet"]}, horizon=2 * HORIZON)
    assert [panel["title"] for panel in charts(short, PERCENT)["coverage"]] == ["at T = 10"]  # no clip reaches 2T
