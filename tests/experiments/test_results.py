"""Which data sets run, and the table and page that come of them."""

from pathlib import Path

import yaml

from experiments.records import Result
from experiments.results import kept, ordered, runnable
from experiments.tables import page, verdict
from experiments.tracker_runs import collect, experiments

DATASETS = yaml.safe_load((Path(__file__).parents[2] / "params.yaml").read_text())["datasets"]

SPEED = {"machine": "a machine", "cores": 2, "rates": {"bowls": {"lab": 9.0}}, "all_cores": {"bowls": 1234.0}}


def result(ours: float, lab: float, **more: object) -> Result:
    rows = {
        "unsupervised": {"mean_px": ours, "p99_px": 2 * ours, "locked": True, "hota": None, "paper_mean_px": 4.1},
        "lab": {"mean_px": lab, "p99_px": 9.0, "locked": None, "hota": None, "lost": 0.25},
        "centre": {"mean_px": 0.1, "p99_px": 0.1, "locked": None, "hota": None},
        "flow_blob": {"mean_px": 0.2, "p99_px": 0.2, "locked": None, "hota": None},
    }
    fields = {"commit": "abc1234", "finished": "2026-01-02T03:04:05+00:00", "machine": "here", "time_s": 60.0}
    return Result({"bowls": rows}, **{**fields, **more})  # type: ignore[arg-type]


def table(*seeds: Result, speed: dict | None = None) -> dict:
    wanted = experiments(["bowls", "bowls2"], DATASETS, range(len(seeds)))
    known = {wanted["bowls", "sequential", seed]: each for seed, each in enumerate(seeds)}
    return collect(wanted, known, speed or {})


def test_film_runs_where_it_is_and_the_cheapest_set_first(tmp_path):
    names, absent = runnable(DATASETS, tmp_path)
    assert names.index("bowls") < names.index("bowls2")
    assert all("simulate" in DATASETS[name] for name in names)
    assert "tray" in absent
    (tmp_path / "tray.dvc").touch()
    names, absent = runnable(DATASETS, tmp_path)
    assert names[0] == "tray"
    assert "tray" not in absent


def test_every_recipe_and_seed_of_a_set_is_an_experiment_of_its_own():
    wanted = experiments(["bowls", "tray"], DATASETS, [0, 1, 2])
    sets = [("joint", "bowls"), ("joint", "tray"), ("sequential", "bowls"), ("sequential", "tray")]
    assert [(recipe, name) for name, recipe, _ in wanted][:12:3] == sets
    assert list(wanted)[12:] == [("bowls", "flow", 0), ("tray", "flow", 0)]
    assert len({each.name for each in wanted.values()}) == 14
    assert "run.simulated=[]" in wanted["tray", "joint", 1].overrides


def test_one_recipe_is_told_how_many_objects_there_are_and_the_other_is_not():
    wanted = experiments(["bowls2"], DATASETS, [0])
    count = "datasets.bowls2.motion.objects=null"
    assert count not in wanted["bowls2", "sequential", 0].overrides
    assert count in wanted["bowls2", "joint", 0].overrides
    beside = {*wanted["bowls2", "flow", 0].overrides} - {*wanted["bowls2", "joint", 0].overrides}
    assert beside == {"run.flow=[corrflow]"}  # so our tracker need not be learned again for it


def test_each_recipe_has_a_row_of_its_own_and_the_others_are_in_once():
    wanted = experiments(["bowls"], DATASETS, [0])
    known = {wanted["bowls", "sequential", 0]: result(0.5, 1.0), wanted["bowls", "joint", 0]: result(0.25, 1.0)}
    rows = collect(wanted, known, {})["bowls"]
    assert list(rows) == ["unsupervised_joint", "lab", "centre", "flow_blob", "unsupervised"]
    assert (rows["unsupervised"]["mean_px"], rows["unsupervised_joint"]["mean_px"]) == (0.5, 0.25)


def test_rows_hold_mean_worst_seeds_commit_machine_and_time():
    found = table(result(0.5, 1.0), result(1.5, 1.0, time_s=90.0), speed={"bowls": {"lab": 321.0}})
    assert list(found) == ["bowls"]
    row = found["bowls"]["unsupervised"]
    assert (row["mean_px"], row["worst"]["mean_px"], row["locked"], row["hota"]) == (1, 1.5, True, None)
    assert (row["seeds"], row["commit"], row["machine"], row["time_s"]) == ([0, 1], "abc1234", "here", 90)
    assert row["frames_per_s"] is None
    assert found["bowls"]["lab"]["frames_per_s"] == 321
    elsewhere = table(result(0.5, 1.0), result(0.5, 1.0, machine=None, time_s=None))["bowls"]["lab"]
    assert (elsewhere["machine"], elsewhere["time_s"]) == ("elsewhere and here", None)


def test_the_page_has_a_line_a_tracker_and_says_what_did_not_run():
    text = page(table(result(0.5, 1.0), result(1.5, 1.0)), {"tray": "no film"}, SPEED)
    lines = text.splitlines()
    assert "| tracker | mean px | paper | 99 % px | lost | locked |" in lines
    assert "| `unsupervised_sequential` | 1.00 (1.50) | 4.10 | 2.00 (3.00) | – | yes |" in lines
    assert "| `lab` | 1.00 | – | 9.00 | 0.25 | – |" in lines
    assert next(line for line in lines if line.startswith("| `")).startswith("| `unsupervised_sequential`")
    assert "HOTA" not in text
    assert "Not run yet: `unsupervised_joint`, `flow_simple`." in lines
    assert lines[-1] == "- `tray`: no film"
    assert "one thread of a machine; ours on its 2 cores: 1,234 (`bowls`)." in text


def test_where_some_seeds_lock_the_page_says_how_many():
    doubtful = result(1.5, 1.0)
    doubtful.figures["bowls"]["unsupervised"]["locked"] = False
    lines = page(table(result(0.5, 1.0), doubtful), {}, SPEED).splitlines()
    assert "| `unsupervised_sequential` | 1.00 (1.50) | 4.10 | 2.00 (3.00) | – | 1 of 2 |" in lines


def test_the_page_says_which_rows_have_other_seeds_or_are_of_another_commit():
    rows = table(result(0.5, 1.0), result(1.5, 1.0))["bowls"]
    rows |= {"flow_blob": rows["flow_blob"] | {"seeds": [0], "commit": "def5678"}}
    told = page({"bowls": rows}, {}, SPEED).splitlines()
    assert any(
        line.startswith("Seeds 0, 1; commit abc1234; here, 60 s the longest seed; finished 2026-01-02.")
        and line.endswith(" Seed 0; commit def5678: `flow_blob`.")
        for line in told
    )
    assert ": `lab`" not in "".join(told)


def test_the_verdict_is_between_ours_and_tools_that_learn_nothing():
    won = verdict(table(result(0.5, 1.0))["bowls"])
    assert won.startswith("In mean ours is as good or better: 1.00 px of `lab` (it lost 25% of")
    lost = verdict(table(result(1.5, 1.0))["bowls"])
    assert "In mean `lab` wins, which is told where each object first is: 1.00 px" in lost
    assert "In 99th percentile ours is as good" in lost
    assert verdict({"unsupervised": {"mean_px": None}}).startswith("No tool")
    rows = {"unsupervised": {"mean_px": 1.0}, "lab": {"mean_px": 0.5}, "knn_blob": {"mean_px": 2.0}}
    assert verdict(rows).endswith("Of those told no start `knn_blob` is best: 2.00 px.")
    assert "told" not in verdict(rows | {"knn_blob": {"mean_px": 0.4}})


def test_rows_stand_until_they_are_measured_again_with_as_many_seeds():
    old, new, fewer = ({"seeds": seeds} for seeds in ([0, 1], [1, 2], [3]))
    before = {"bowls": {"lab": old, "knn_blob": old, "centre": old}, "tray": {"lab": old}}
    after = kept(before, {"bowls": {"lab": new, "centre": fewer, "flow_blob": fewer}})
    assert after["bowls"] == {"lab": new, "knn_blob": old, "centre": old, "flow_blob": fewer}
    assert after["tray"] == before["tray"]


def test_sets_stand_in_one_order_whichever_ran_last():
    table = {"old": {}, "heights": {}, "bowls": {}}
    assert list(ordered(table, ["bowls", "bowls2", "heights"])) == ["bowls", "heights", "old"]
