"""Names of experiments and what is read back of them."""

from pathlib import Path

import pytest
import yaml
from pretended_dvc import BASE, TRACKERS, Pretended

from experiments.records import (
    AFTER_TRACKS,
    CommandError,
    Experiment,
    command,
    finished,
    machine,
    note_cost,
    on_one_set,
    read_results,
)

ROOT = Path(__file__).parents[2]
ONE, TWO = Experiment("one", ("x=1",)), Experiment("two", ("x=2", "y=[]"))


def test_an_experiment_s_name_tells_its_overrides_apart():
    assert ONE.name.startswith("one-")
    assert ONE.name == Experiment("one", ("x=1",)).name
    assert len({ONE.name, Experiment("one", ("x=2",)).name, Experiment("one", ("x=1", "y=1")).name}) == 3


def test_results_carry_commit_date_machine_and_time():
    note_cost(ONE.name, 12.0)
    here = read_results([ONE, TWO], Pretended(finished=[(ONE.name, BASE)]))[ONE]
    assert (here.figures, here.commit, here.finished) == (TRACKERS, BASE[:7], "2026-01-02T03:04:05+00:00")
    assert (here.machine, here.time_s) == (machine(), 12)
    elsewhere = read_results([TWO], Pretended(finished=[(TWO.name, BASE)]))[TWO]
    assert (elsewhere.machine, elsewhere.time_s) == (None, None)


def test_code_of_forecasts_alone_makes_no_track_and_every_forecast_out_of_date():
    told: list[tuple[str, ...]] = []

    def git(*words: str) -> str:
        told.append(words)
        answers = {"for-each-ref": f"{'1' * 40} refs/exps/{BASE[:2]}/{BASE[2:]}/{ONE.name}", "show": "{}"}
        return answers.get(words[1], "")

    for each in (ONE, ONE._replace(measured="predictors")):
        assert finished([each], git) == {ONE.name: "1" * 40}
    assert [f":(exclude){AFTER_TRACKS[0]}" in words for words in told if words[1] == "diff"] == [True, False]


PARAMS = {
    "tracker": {"steps": 9},
    "datasets": {"bowls": {"T": 20}, "tray": {"T": 40}},
    "predictors": {"vin": {"width": 8}, "terrain": {"width": 8}},
    "finetune": {"weight": 1},
}


@pytest.mark.parametrize(
    ("changed", "stale"),
    [
        ({"tracker": {"steps": 10}}, {"tracks", "forecasts", "tuned"}),
        ({"datasets": {"bowls": {"T": 21}, "tray": {"T": 40}}}, {"tracks", "forecasts", "tuned"}),
        ({"datasets": {"bowls": {"T": 20}, "tray": {"T": 41}}}, set()),
        ({"predictors": {"vin": {"width": 9}, "terrain": {"width": 8}}}, {"forecasts", "tuned"}),
        ({"predictors": {"vin": {"width": 8}, "terrain": {"width": 9}}}, set()),
        ({"finetune": {"weight": 2}}, {"tuned"}),
    ],
)
def test_params_that_an_experiment_does_not_read_leave_it_as_it_is(changed, stale):
    wanted = {
        "tracks": Experiment("tracks", on_one_set("bowls", 0, simulated=True)),
        "forecasts": Experiment("forecasts", on_one_set("bowls", 0, True, "vin"), "predictors"),
        "tuned": Experiment("tuned", on_one_set("bowls", 0, True, "vin", finetuned=True)),
    }

    def git(*words: str) -> str:
        refs = [f"{'1' * 40} refs/exps/{BASE[:2]}/{BASE[2:]}/{each.name}" for each in wanted.values()]
        now = PARAMS | changed if words[-1].startswith("HEAD") else PARAMS
        return {"for-each-ref": "\n".join(refs), "show": yaml.safe_dump(now)}.get(words[1], "")

    left = finished(wanted.values(), git)
    assert {name for name, each in wanted.items() if each.name not in left} == stale


def test_only_one_data_set_s_trackers_are_left_to_run():
    assert "run.simulated=[bowls]" in on_one_set("bowls", 1, simulated=True)
    film = on_one_set("tray", 2, simulated=False)
    assert {"run.datasets=[tray]", "run.simulated=[]", "run.learned=[]", "compute.seed=2"} <= set(film)


def test_no_stage_of_a_tracker_reads_the_code_that_may_change():
    stages = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
    readers = {name for name, stage in stages.items() if set(AFTER_TRACKS) & set(stage.get("do", stage)["deps"])}
    of_trackers = {name for name in stages if "track" in name or name in {"simulate", "ingest", "ground_truth"}}
    assert of_trackers > {"train_tracker", "export_tracks", "evaluate_trackers"}
    assert readers
    assert not readers & (of_trackers | {"mask_objects", "train_flow", "report"})


def test_a_command_that_fails_says_why():
    with pytest.raises(CommandError, match="git no-such-command"):
        command("git", "no-such-command")
