"""The page and the metrics say what tuning tracker and predictor together gained, and what of it is used."""

import re
from dataclasses import replace

import pytest
from pydantic import ValidationError

from physpipe.io import results
from physpipe.report.headlines import headlines
from physpipe.report.page import write_page
from physpipe.report.paper import predictor_rows, tracker_rows
from physpipe.report.run import TUNED, RunParams
from physpipe.report.tables import save_metrics


@pytest.fixture(scope="module")
def asked(project):
    """The made-up project, asked to tune DispNet with its tracker."""
    return replace(project, run=project.run.model_copy(update={"finetuned": ["dispnet"]}))


def test_rows_of_the_tuned_two_stand_beside_the_others(asked):
    bowls = asked.evidence("bowls")
    assert list(tracker_rows(bowls))[-1] == "unsupervised_with_dispnet"
    assert list(predictor_rows(bowls)) == ["tracks", "truth", TUNED]
    assert list(predictor_rows(bowls)[TUNED]) == ["dispnet"]
    for what in ("dispnet from unsupervised tracks, tuned", "dispnet from unsupervised tracks, at T"):
        (line,) = [
            each for each in headlines([bowls], "dispnet") if each.what.startswith(what) and "2T" not in each.what
        ]
        assert line.persistence == 40


def test_where_the_former_two_stay_no_row_is_called_tuned(asked):
    film = asked.evidence("film")
    assert "unsupervised_with_dispnet" not in tracker_rows(film)
    assert list(predictor_rows(film)) == ["tracks"]
    assert not film.tuning["dispnet"]["gained"]


def test_the_metrics_keep_the_verdict(asked, tmp_path):
    save_metrics(tmp_path, asked.every(), "dispnet")
    predictors = results.load_json(tmp_path / "predictors.json")
    assert [predictors[name]["tuning"]["dispnet"]["gained"] for name in ("bowls", "film")] == [True, False]
    assert "tuned" not in predictors["film"]


def test_the_page_tells_before_after_and_whether_it_is_used(asked, tmp_path):
    write_page(tmp_path / "report", asked.every(), asked.ablation, 7, asked.shown, asked.lock)
    bowls, film = (tmp_path / "report/index.html").read_text().split('<table class="tuning">')[1:]
    for told, kept in ((bowls, "yes"), (film, "no")):
        score, detections, forecasts, loss = ("0.310", "0.310"), ("0.560", "0.250"), ("2.16", "2.16"), ("2.50", "2.50")
        cells = re.findall(r"<data[^>]*>(.*?)</data>", told.split("</table>")[0])
        assert cells == ["no", "no", kept, *score, *detections, *forecasts, *loss]


def test_without_it_nothing_of_it_is_told(folder):
    assert "tuned together" not in (folder / "index.html").read_text()


def test_a_predictor_that_has_not_learned_cannot_be_tuned():
    with pytest.raises(ValidationError, match=r"terrain must be in `run\.learned`, too"):
        RunParams(datasets=["bowls"], simulated=[], learned=["dispnet"], supervised=[], flow=[], finetuned=["terrain"])
