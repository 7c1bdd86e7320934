"""A model has one colour, on the page and in the plots of `dvc plots`."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from physpipe.baselines.zoo import BASELINES as TRACKERS
from physpipe.core.horizon import BASELINES
from physpipe.report import colours
from physpipe.report.glossary import LOSSES

TEMPLATES = Path(__file__).parents[2] / "metrics" / "templates"


@pytest.mark.parametrize(
    ("name", "field", "expected"),
    [("error_by_horizon", "predictor", colours.PREDICTORS), ("tracker_errors", "tracker", colours.TRACKERS)],
)
def test_templates_colour_as_the_page_does(name, field, expected):
    template = json.loads((TEMPLATES / f"{name}.json").read_text())
    lookup = template["transform"][0]
    assert lookup["lookup"] == lookup["from"]["key"] == field
    assert {row[field]: row["colour"] for row in lookup["from"]["data"]["values"]} == expected
    assert lookup["default"] == colours.FALLBACK
    curves, key = template["hconcat"]
    for each in (curves["spec"], key):
        assert each["encoding"]["color"] == {"field": "colour", "type": "nominal", "scale": None}


def test_learning_curves_have_the_words_and_the_colours_of_the_page():
    template = json.loads((TEMPLATES / "learning.json").read_text())
    lookup = template["transform"][0]
    assert {row["loss"]: row["words"] for row in lookup["from"]["data"]["values"]} == LOSSES
    shades = template["spec"]["encoding"]["color"]["scale"]["range"]
    assert shades[: len(colours.PALETTE)] == list(colours.PALETTE)
    assert set(shades) <= set(colours.PREDICTORS.values()) | set(colours.TRACKERS.values())


@pytest.mark.parametrize("name", ["error_by_horizon", "tracker_errors", "learning"])
def test_templates_have_dvcs_anchors(name):
    text = (TEMPLATES / f"{name}.json").read_text()
    assert all(
        anchor in text for anchor in ("<DVC_METRIC_DATA>", "<DVC_METRIC_X>", "<DVC_METRIC_Y>", "<DVC_METRIC_TITLE>")
    )


def test_every_model_of_the_project_has_a_colour():
    params = yaml.safe_load((TEMPLATES.parents[1] / "params.yaml").read_text())
    assert colours.PREDICTORS.keys() == {*BASELINES, *params["predictors"]}
    assert colours.TRACKERS.keys() == {"unsupervised", "unsupervised_unrefined", *TRACKERS}


@pytest.mark.parametrize("zoo", [colours.PREDICTORS, colours.TRACKERS])
def test_no_two_models_have_nearly_the_same_colour(zoo):
    rgb = np.float32([[colours.rgb(each) for each in zoo.values()]]) / 255
    lab = cv2.cvtColor(rgb, cv2.COLOR_RGB2LAB)[0]
    apart = np.linalg.norm(lab[:, None] - lab[None], axis=-1)[np.triu_indices(len(zoo), 1)]
    assert apart.min() > 25  # units of CIELAB; 2.3 can just be told apart side by side


def test_a_model_without_a_colour_still_gets_one():
    assert colours.rgb(colours.of_tracker("of tomorrow")) == (140, 140, 140)
