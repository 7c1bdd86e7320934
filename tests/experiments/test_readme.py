"""The README's tables are those of the metrics files."""

from pathlib import Path

import pytest

from experiments.readme import BEGIN, END, from_metrics, inserted, tables

ROOT = Path(__file__).parents[2]
TRACKERS = {
    "rink": {
        "unsupervised": {"mean_px": 0.4, "paper_mean_px": 1.9, "p99_px": 1.25, "off_track": 0.0, "locked": True},
        "lab": {"mean_px": 0.5, "p99_px": 1.0, "off_track": 0.0, "locked": None},
        "knn_blob": {"mean_px": 0.3, "p99_px": 3.0, "off_track": 0.125, "locked": None},
        "centre": {"mean_px": 0.1, "p99_px": 0.1, "off_track": 1.0, "locked": None},
    },
    "nobody_annotated": {"unsupervised": {"mean_px": None, "locked": False}},
}
PREDICTORS = {
    "rink": {
        "tracks": {
            "persistence": {"error_T_px": 9.0, "error_2T_px": 18.0},
            "linear": {"error_T_px": 1.0, "error_2T_px": 2.0},
            "vin": {"error_T_px": 3.0, "error_2T_px": 6.0, "paper_error_2T_px": 7.5},
        },
        "calibration": {"linear_T_px": 1.0},
    }
}


def test_the_readme_has_the_tables_of_the_committed_metrics():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert inserted(text, from_metrics(ROOT / "metrics")) == text, "`python -m experiments.readme` writes them"


def test_a_row_is_ours_or_the_best_that_learns_nothing_and_the_paper_s_figure_stands_beside():
    assert tables(TRACKERS, PREDICTORS).strip().splitlines() == [
        "| set | tracker | mean px | paper | 99 % px | off track | locked |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: |",
        "| rink | `unsupervised` | 0.40 | 1.90 | 1.25 | 0.00 | yes |",
        "| rink | `knn_blob` | 0.30 | – | 3.00 | 0.12 | – |",
        "",
        "| set | predictor | learned from | at T px | at 2T px | paper |",
        "| --- | --- | --- | ---: | ---: | ---: |",
        "| rink | `vin` | unsupervised tracks | 3.00 | 6.00 | 7.50 |",
        "| rink | `persistence` | unsupervised tracks | 9.00 | 18.00 | – |",
    ]


def test_only_what_stands_between_the_marks_is_replaced_and_marks_must_be_there():
    text = f"before\n{BEGIN}old\n{END}after\n"
    assert inserted(text, "new\n") == f"before\n{BEGIN}new\n{END}after\n"
    for broken in ("before\n", f"{END}{BEGIN}", text + text):
        with pytest.raises(ValueError, match="needs the lines"):
            inserted(broken, "new\n")
