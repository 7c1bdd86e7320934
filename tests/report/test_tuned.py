"""The page and the metrics say what tuning tracker and predictor together gained, and what of it is used."""

import re
from dataclasses import replace

import pytest
from pydantic import ValidationError

from physpipe.report.page import write_page
from physpipe.report.paper import predictor_rows, tracker_rows
from physpipe.report.run import TUNED, RunParams


@pytest.fixture(scope="module")
def asked(project):
    """The made-up project, asked to tune DispNet with its tracker."""
    return replace(project, run=project.run.model_copy(update={"finetuned": ["dispnet"]}))


def test_rows_of_the_tuned_two_stand_beside_the_others(asked):
    bowls = asked.evidence("bowls")
    assert list(tracker_rows(bowls))[-1] == "unsupervised_with_dispnet"
    assert list(predictor_rows(bowls)) == ["tracks", "truth", TUNED]
    assert list(predictor_rows(bowls)[TUNED]) == ["dispnet"]


def test_the_page_tells_before_after_and_whether_it_is_used(asked, tmp_path):
    write_page(tmp_path / "report", asked.every(), asked.ablation, 7, asked.shown, asked.lock)
    bowls, film = (tmp_path / "report/index.html").read_text().split('<table class="tuning">')[1:]
    for told, used in ((bowls, "yes"), (film, "no")):
        table = told.split("</table>")[0]
        assert re.findall(r"<data[^>]*>(.*?)</data>", table) == [
            "0.310",
            "0.310",
            "0.560",
            "0.250",
            "2.16",
            "2.16",
            used,
        ]


def test_without_it_nothing_of_it_is_told(folder):
    assert "tuned together" not in (folder / "index.html").read_text()


def test_a_predictor_that_has_not_learned_cannot_be_tuned():
    with pytest.raises(ValidationError, match="`finetuned` names terrain, which `learned` does not"):
        RunParams(datasets=["bowls"], simulated=[], learned=["dispnet"], supervised=[], flow=[], finetuned=["terrain"])
