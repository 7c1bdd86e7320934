"""The metrics files say what the scores say, of this run only, and beside it what the paper says."""

import json
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from physpipe.core.errors import InputError
from physpipe.io import results
from physpipe.report import paper
from physpipe.report.evidence import gather
from physpipe.report.tables import save_metrics, summary


@pytest.fixture(scope="module")
def metrics(project, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("metrics")
    save_metrics(folder, project.every(), "dispnet")
    return folder


def strict(path: Path):
    def refuse(word: str):
        raise AssertionError(f"{path} holds {word}")

    return json.loads(path.read_text(), parse_constant=refuse)


def test_trackers_json_holds_the_scores(project, metrics):
    scores = {name: results.load_json(project.sources.scores / name / "trackers.json") for name in ("bowls", "film")}
    assert strict(metrics / "trackers.json") == scores  # the paper tabulates no tracker on BowlS


def test_paper_stands_beside_the_trackers_of_its_table(bowls):
    rows = paper.tracker_rows(replace(bowls, name="heightr"))
    assert (rows["unsupervised"]["paper_mean_px"], rows["unsupervised"]["paper_var_px2"]) == (3.3, 0.5)
    assert "paper_mean_px" not in rows["centre"]


def test_a_stand_in_has_the_figures_of_the_set_that_it_stands_in_for(bowls):
    real, simulated = (paper.tracker_rows(replace(bowls, name=name)) for name in ("heightr2", "heightr2_sim"))
    assert simulated == real
    assert simulated["unsupervised"]["paper_off_track"] == 0
    tables = paper._paper()
    assert set(tables["stand_ins"].values()) == set(tables["trackers"])


def test_predictors_json_holds_the_scores_beside_the_papers_figures(project, metrics):
    scores = results.load_json(project.sources.scores / "bowls" / "predictors.json")
    written = strict(metrics / "predictors.json")["bowls"]
    assert written["tracks"]["persistence"] == scores["tracks"]["persistence"]
    printed = {"paper_error_T_px": 3.9, "paper_error_2T_px": 25.6}
    assert written["tracks"]["dispnet"] == {**scores["tracks"]["dispnet"], **printed}
    assert written["truth"]["linear"]["paper_error_T_px"] == 20.1  # the table prints the two cells swapped
    assert written["truth"]["linear"]["paper_error_2T_px"] == 61.9
    assert "paper_error_T_px" not in written["tracks"]["linear"]  # a row that the paper's block lacks


def test_other_runs_leave_no_trace(metrics):
    text = "".join(path.read_text() for path in metrics.iterdir())
    assert "vin" not in text  # scored, but by another run
    assert "old" not in text
    assert "truth" not in strict(metrics / "predictors.json")["film"]  # scored, but not in run.supervised


def test_summary_is_small_and_its_numbers_are_those_of_the_tables(metrics):
    trackers, predictors = strict(metrics / "trackers.json"), strict(metrics / "predictors.json")
    ours = predictors["bowls"]["tracks"]["dispnet"]
    assert strict(metrics / "summary.json") == {  # of `film` nobody knows the truth
        "locked": False,
        "bowls_track_px": trackers["bowls"]["unsupervised"]["mean_px"],
        "bowls_T_px": ours["error_T_px"],
        "bowls_2T_px": ours["error_2T_px"],
    }


def test_summary_says_locked_when_every_set_is(bowls, film):
    assert summary([bowls], "dispnet")["locked"] is True
    assert summary([bowls, film], "dispnet")["locked"] is False


def test_calibration_is_a_ratio_to_the_papers_polynomials(metrics):
    row = strict(metrics / "predictors.json")["bowls"]["calibration"]
    assert row["ratio_linear_2T"] == pytest.approx(65.0 / 61.9, abs=1e-6)
    assert row["ratio_quadratic_T"] == pytest.approx(12.0 / 11.7, abs=1e-6)
    assert row["linear_T_px"] == 19.0


def test_summary_takes_the_named_predictor(project):
    evidence = project.evidence("bowls")
    named = evidence.predictors["tracks"]["probnet"]["error_T_px"]
    assert summary([evidence], "probnet")["bowls_T_px"] == named != summary([evidence], "dispnet")["bowls_T_px"]


def test_csv_files_are_long_and_small(metrics):
    curves = pd.read_csv(metrics / "curves.csv")
    assert list(curves) == ["dataset", "supervision", "predictor", "frame", "error_px"]
    assert set(curves["predictor"]) == {"persistence", "linear", "quadratic", "dispnet", "probnet"}
    errors = pd.read_csv(metrics / "tracker_errors.csv")
    assert errors.groupby(["dataset", "tracker"]).size().max() <= 41
    learning = pd.read_csv(metrics / "learning.csv")
    assert list(learning) == ["dataset", "model", "step", "loss", "value"]
    assert learning.groupby(["dataset", "model", "loss"]).size().max() <= 200


LONG_TERM = {"error_T_px", "error_2T_px"}
PROBABILISTIC = {*LONG_TERM, "nll_bits", "nll_bits_2T"}


@pytest.mark.parametrize("dataset", ["bowls", "heights", "poolr", "bowlr", "heightr", "bowls2", "heightr2"])
def test_every_row_of_the_papers_predictor_tables_is_there(dataset):
    """Three tables of errors at T and 2 T, two of errors at frames 10, 20, 30 and, where learned to 40, 40."""
    blocks = dict(paper._paper()["predictors"][dataset])
    last = 30 if dataset in ("poolr", "bowls2", "heightr2") else 40
    fixed = {f"error_{frame}_px" for frame in range(10, last + 1, 10)}
    long_term = dict.fromkeys(("ifs", "vin", "posnet", "dispnet"), LONG_TERM) | {"probnet": PROBABILISTIC}
    rows = {name: set(row) for name, row in blocks.pop("tracks").items()}
    assert rows == {**long_term, "dispnet_long": fixed, "interpnet": fixed}
    supervised = {name: set(row) for name, row in blocks.get("truth", {}).items()}
    assert supervised == ({**long_term, "linear": LONG_TERM, "quadratic": LONG_TERM} if "truth" in blocks else {})
    assert ("truth" in blocks) == (dataset in ("bowls", "heights"))


def test_the_papers_tracker_tables_hold_known_figures():
    for rows in paper._paper()["trackers"].values():
        for row in rows.values():
            assert {"mean_px", "var_px2"} <= set(row) <= {"mean_px", "var_px2", "off_track"}


def test_a_predictor_without_scores_is_named(project):
    run = project.run.model_copy(update={"learned": ["dispnet", "ifs"]})
    with pytest.raises(InputError, match="lacks scores of tracks ifs, truth ifs"):
        gather("bowls", run, project.sources, "dispnet")


def test_a_missing_score_file_is_named(project):
    with pytest.raises(InputError, match=r"nowhere.+no such file"):
        project.evidence("nowhere")
