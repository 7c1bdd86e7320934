"""What tuning tracker and predictor together gained, from both files of one experiment."""

from pathlib import Path

import yaml

from experiments.records import Result
from experiments.tuning_runs import collect, experiments, gained, of_trackers, page

DATASETS = yaml.safe_load((Path(__file__).parents[2] / "params.yaml").read_text())["datasets"]
WANTED = experiments(["bowls", "heights"], DATASETS, seed=3)


def result(figures: dict) -> Result:
    return Result({"bowls": figures}, "abc1234", "2026-01-02T03:04:05+00:00", "here", 60.0)


def known() -> dict:
    trackers = {
        "unsupervised": {"mean_px": 0.3},
        "unsupervised_unrefined": {"mean_px": 0.5},
        "unsupervised_with_dispnet": {"mean_px": 0.31},
        "unsupervised_unrefined_with_dispnet": {"mean_px": 0.25},
    }
    predictors = {
        "tracks": {"dispnet": {"error_T_px": 4.0, "error_2T_px": 8.0}},
        "tuned": {"dispnet": {"error_T_px": 3.5, "error_2T_px": None}},
        "tuning": {"dispnet": {"gained": True}},
    }
    return {WANTED["bowls"]: result(predictors), of_trackers(WANTED["bowls"]): result(trackers)}


def test_both_views_are_of_one_experiment_that_tunes_what_it_learned():
    one = WANTED["bowls"]
    assert one.name == of_trackers(one).name
    assert {"run.learned=[dispnet]", "run.finetuned=[dispnet]", "compute.seed=3"} <= set(one.overrides)
    assert (one.measured, of_trackers(one).measured) == ("predictors", "trackers")


def test_a_row_holds_before_and_after_and_whether_it_is_used():
    row = collect(WANTED, known(), seed=3)["bowls"]
    assert (row["kept"], row["commit"], row["seeds"]) == (True, "abc1234", [3])
    assert (row["detections_px_before"], row["detections_px_after"]) == (0.5, 0.25)
    assert (row["track_px_before"], row["track_px_after"]) == (0.3, 0.31)
    assert (row["T_px_before"], row["T_px_after"], row["2T_px_after"]) == (4.0, 3.5, None)


def test_where_the_former_two_stay_nothing_changes():
    found = known()
    found[WANTED["bowls"]].figures["bowls"] |= {"tuning": {"dispnet": {"gained": False}}}
    del found[WANTED["bowls"]].figures["bowls"]["tuned"]
    row = collect(WANTED, found, seed=3)["bowls"]
    assert not row["kept"]
    assert (row["detections_px_after"], row["T_px_after"]) == (row["detections_px_before"], row["T_px_before"])


def test_the_page_says_what_was_gained_and_lost_where_the_pair_was_kept():
    table = collect(WANTED, known(), seed=3)
    told = gained(table)
    assert told.startswith("Kept on 1 of 1 sets.")
    assert "detections px -0.250 (`bowls`); tracks px +0.010 (`bowls`); at T px -0.500 (`bowls`)." in told
    assert gained({"bowls": table["bowls"] | {"kept": False}}) == "Kept on 0 of 1 sets.\n"


def test_one_file_alone_makes_no_row():
    assert collect(WANTED, {WANTED["bowls"]: result({})}, seed=3) == {}


def test_the_page_has_a_line_a_set_and_names_what_has_not_run():
    lines = page(collect(WANTED, known(), seed=3), ["bowls", "heights"]).splitlines()
    assert "| `bowls` | yes | 0.50 | 0.25 | 0.30 | 0.31 | 4.00 | 3.50 | 8.00 | – | abc1234 |" in lines
    assert "Not run yet: `heights`." in lines
    assert not any(each.startswith("|") for each in page({}, ["bowls"]).splitlines())
