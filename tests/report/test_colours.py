"""A model has one colour, on the page and in the plots of `dvc plots`."""

import json
from pathlib import Path

import pytest

from physpipe.report import colours

TEMPLATES = Path(__file__).parents[2] / "metrics" / "templates"


@pytest.mark.parametrize(
    ("name", "field", "expected"),
    [("error_by_horizon", "predictor", colours.PREDICTORS), ("tracker_errors", "tracker", colours.TRACKERS)],
)
def test_templates_colour_as_the_page_does(name, field, expected):
    colour = json.loads((TEMPLATES / f"{name}.json").read_text())["spec"]["encoding"]["color"]
    assert colour["field"] == field
    assert dict(zip(colour["scale"]["domain"], colour["scale"]["range"], strict=True)) == expected


@pytest.mark.parametrize("name", ["error_by_horizon", "tracker_errors", "learning"])
def test_templates_have_dvcs_anchors_and_tell_revisions_apart(name):
    text = (TEMPLATES / f"{name}.json").read_text()
    assert all(
        anchor in text for anchor in ("<DVC_METRIC_DATA>", "<DVC_METRIC_X>", "<DVC_METRIC_Y>", "<DVC_METRIC_TITLE>")
    )
    assert json.loads(text)["spec"]["encoding"]["strokeDash"]["field"] == "rev"


@pytest.mark.parametrize("zoo", [colours.PREDICTORS, colours.TRACKERS])
def test_no_two_models_share_a_colour(zoo):
    assert len(set(zoo.values())) == len(zoo)


def test_a_model_without_a_colour_still_gets_one():
    assert colours.rgb(colours.of_tracker("of tomorrow")) == (140, 140, 140)
