"""The plate shows the clip that its rule names, and every drawn predictor of the run."""

import base64
import re
from dataclasses import replace

import cv2
import numpy as np
import pandas as pd
import pytest

from physpipe.report.page import write_page
from physpipe.report.pairs import missed
from physpipe.report.plate import COLUMNS, Choice, PlateParams, median_clip, plate

PARAMS = PlateParams(reach=2, spots=2, background_frames=9)


def with_errors(bowls, errors_px: dict[str, float]):
    """Evidence whose test clips are `errors_px`, copies of one clip forecast so far off along x at every frame."""
    table, truth, track = (each[each["clip"] == "bowls_003"] for each in (bowls.forecast, bowls.truth, bowls.track))
    true = truth.set_index("frame").loc[table["frame"]]
    right = table.assign(x=true["x"].to_numpy(), y=true["y"].to_numpy())
    made = [right.assign(clip=name, x=right["x"] + px) for name, px in errors_px.items()]

    class Clips:
        def names(self, *splits: str) -> list[str]:
            return list(errors_px) if splits else ["train", *errors_px]

    def copies(table: pd.DataFrame) -> pd.DataFrame:
        return pd.concat([table.assign(clip=name) for name in errors_px])

    return replace(bowls, forecast=pd.concat(made), truth=copies(truth), track=copies(track), clips=Clips())


@pytest.mark.parametrize(
    ("errors_px", "clip", "error_px"),
    [
        ({"a": 9.0, "b": 1.0, "c": 4.0}, "c", 4.0),
        ({"a": 9.0, "b": 1.0, "c": 4.0, "d": 2.0}, "d", 2.0),
        ({"a": 3.0}, "a", 3.0),
    ],
)
def test_the_clip_is_the_median_one(bowls, errors_px, clip, error_px):
    choice = median_clip(with_errors(bowls, errors_px))
    assert (choice.clip, choice.of) == (clip, len(errors_px))
    assert choice.error_px == pytest.approx(error_px, abs=1e-3)


def test_only_clips_that_are_forecast_and_tracked_count(bowls):
    every = with_errors(bowls, {"a": 9.0, "b": 1.0, "c": 4.0})
    track, forecast = every.track, every.forecast
    assert median_clip(replace(every, track=track[track["clip"] != "c"])).clip == "b"
    assert median_clip(replace(every, forecast=forecast[forecast["clip"] != "c"])).clip == "b"
    assert median_clip(replace(every, forecast=forecast.iloc[:0])) is None


def test_without_truth_it_is_the_middle_one(film):
    assert median_clip(film) == Choice("film_003", None, 2)


def test_every_drawn_predictor_has_a_panel_with_its_errors(bowls, project):
    world, row = project.world, plate(bowls, PARAMS, 3)
    assert [panel["predictor"] for panel in row["panels"]] == ["dispnet", "probnet", "linear", "quadratic"]
    assert (row["last"], row["columns"], row["probabilistic"]) == (2 * world.horizon, 4, True)
    for panel in row["panels"]:
        assert panel["seen"] == world.seen - 1
        found = missed(bowls.forecasts[panel["predictor"]], bowls.truth)[row["clip"]]
        assert (panel["T_px"], panel["2T_px"]) == (found.error_px(world.horizon), found.error_px(2 * world.horizon))
        raw = base64.b64decode(panel["picture"].removeprefix("data:image/webp;base64,"))
        shown = cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR)
        assert shown.shape == (3 * world.height, 3 * world.width, 3)


def test_a_clip_shorter_than_the_reach_is_drawn_to_its_end(bowls, project):
    row = plate(bowls, PlateParams(reach=9, spots=4, background_frames=9), 1)
    assert row["last"] == project.world.frames - 1


def test_the_page_holds_the_plate_with_words_for_every_picture(bowls, film, project, tmp_path):
    name = median_clip(bowls).clip
    gap = bowls.forecasts["linear"]
    every = {**bowls.forecasts, "linear": gap[gap["clip"] != name]}
    unknown = replace(film, forecast=film.forecast.iloc[:0])
    write_page(tmp_path / "report", [replace(bowls, forecasts=every), unknown], {}, 7, project.shown, project.lock)
    html = (tmp_path / "report" / "index.html").read_text()
    part = re.search(r'<section id="plate".*?</section>', html, re.DOTALL)[0]
    words = re.findall(r'alt="([^"]*)"', part)
    assert words[0] == f"bowls, {name}: true path and dispnet's forecast up to frame 10"
    assert len(words) == len(every.keys() - {"persistence"}) <= COLUMNS  # standing still has no path
    assert part.count("no forecast of this clip") == 1
    assert part.count("No forecast, so nothing to show") == 1
    assert "is the median of 2 test clips" in part
    assert "rings and dots at frames 5, 10." in part
    assert "what should hold 90 %" in part


def test_without_covariances_the_page_says_nothing_of_ellipses(bowls, project, tmp_path):
    sure = {name: bowls.forecasts[name] for name in ("linear", "quadratic")}
    write_page(tmp_path / "report", [replace(bowls, forecasts=sure)], {}, 7, project.shown, project.lock)
    html = (tmp_path / "report" / "index.html").read_text()
    part = re.search(r'<section id="plate".*?</section>', html, re.DOTALL)[0]
    assert "what should hold 90 %" not in part
    assert 'data-chart="bowls/coverage"' not in html
