"""Figures decode, repeat byte for byte, and draw each model in its colour."""

import cv2
import numpy as np
import pandas as pd
import pytest

from physpipe.report import colours, figures

FRAME = np.arange(1, 30)


def horizons(*predictors: str) -> pd.DataFrame:
    parts = [
        pd.DataFrame({"supervision": each, "predictor": name, "frame": FRAME, "error_px": FRAME * (1.0 + number)})
        for each in ("tracks", "truth")
        for number, name in enumerate(predictors)
    ]
    return pd.concat(parts)


def colour_count(png: bytes, colour: str) -> int:
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
    return int((np.abs(picture.astype(int) - colours.rgb(colour)) < 12).all(axis=2).sum())


@pytest.mark.parametrize("name", ["dispnet", "ifs"])
def test_a_predictor_is_drawn_in_its_colour(name):
    drawn = figures.error_by_horizon(horizons("persistence", name), horizon=7)
    without = figures.error_by_horizon(horizons("persistence"), horizon=7)
    assert colour_count(drawn, colours.of_predictor(name)) > 200  # pixels of a line
    assert colour_count(without, colours.of_predictor(name)) == 0


def test_figures_repeat_byte_for_byte():
    table = horizons("persistence", "dispnet")
    assert figures.error_by_horizon(table, 7) == figures.error_by_horizon(table, 7)


def test_every_kind_of_loss_gets_a_panel():
    curve = pd.DataFrame({"model": "tracker, rest", "step": FRAME, "value": 1.0 / FRAME})
    one = figures.learning_curves(curve.assign(loss="disc"))
    two = figures.learning_curves(pd.concat([curve.assign(loss="disc"), curve.assign(loss="entropy_nats")]))
    widths = [cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR).shape[1] for png in (one, two)]
    assert widths[1] == pytest.approx(2 * widths[0], abs=2)


def test_tracker_errors_draws_every_tracker():
    grid = np.geomspace(0.1, 100, 20)
    table = pd.concat(
        [
            pd.DataFrame({"tracker": name, "error_px": grid, "share": np.linspace(0, top, 20)})
            for name, top in (("unsupervised", 1), ("lab", 0.6))
        ]
    )
    png = figures.tracker_errors(table)
    assert all(colour_count(png, colours.of_tracker(name)) > 100 for name in ("unsupervised", "lab"))
