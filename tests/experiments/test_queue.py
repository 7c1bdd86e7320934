"""What is queued, what is skipped, what is said of failures: against a DVC and a Git that only pretend."""

from pathlib import Path

import pytest
from pretended_dvc import BASE, OLD, Pretended

from experiments.queue import PREDICTORS, run_missing
from experiments.records import CommandError, Experiment, read_results

ONE, TWO = Experiment("one", ("x=1",)), Experiment("two", ("x=2", "y=[]"))


def run(pretended: Pretended, *wanted: Experiment) -> dict[Experiment, str]:
    return run_missing(wanted, jobs=2, run=pretended, wait=lambda _: None)


def test_all_that_is_missing_is_queued_in_order_with_its_overrides():
    pretended = Pretended()
    assert run(pretended, ONE, TWO) == {}
    head, folder = ("dvc", "exp", "run", "--queue", "--name"), ("--copy-paths", PREDICTORS)
    one, two = (*head, ONE.name, *folder, "-S", "x=1"), (*head, TWO.name, *folder, "-S", "x=2", "-S", "y=[]")
    assert pretended.queued == [one, two]
    assert Path(PREDICTORS).is_dir()
    assert ("dvc", "queue", "start", "--jobs", "2") in pretended.said


def test_what_has_results_for_today_s_code_is_not_run_again():
    pretended = Pretended(finished=[(ONE.name, BASE), (TWO.name, OLD)])
    assert run(pretended, ONE, TWO) == {}
    assert [words[5] for words in pretended.queued] == [TWO.name]
    idle = Pretended(finished=[(ONE.name, BASE)])
    run(idle, ONE)
    assert not any(words[0] == "dvc" for words in idle.said)


def test_a_failure_is_named_with_what_the_stage_said_and_the_others_go_on():
    pretended = Pretended(broken=["one"])
    assert run(pretended, ONE, TWO) == {ONE: "error: params.yaml: bad. To mend: mend it."}
    assert set(read_results([ONE, TWO], pretended)) == {TWO}


def test_tasks_of_an_earlier_sitting_are_taken_off_the_queue_and_others_left():
    tasks = [["000aaa1", ONE.name, "Queued"], ["000aaa2", TWO.name, "Failed"], ["000aaa3", "mine", "Queued"]]
    pretended = Pretended(tasks=tasks)
    assert run(pretended, ONE, TWO) == {}
    assert ("dvc", "queue", "remove", "000aaa1", "000aaa2") in pretended.said
    assert len(pretended.queued) == 2
    assert "mine" in [task[1] for task in pretended.tasks]


def test_what_runs_already_is_not_started_twice_unless_its_worker_is_dead():
    with pytest.raises(CommandError, match="already running"):
        run(Pretended(tasks=[["000aaa1", ONE.name, "Running"]], workers=1), ONE)
    assert run(Pretended(tasks=[["000aaa1", ONE.name, "Running"]]), ONE) == {}


def test_uncommitted_code_is_refused_before_anything_is_queued():
    pretended = Pretended(changed=" M params.yaml")
    with pytest.raises(CommandError, match=r"commit these changes first\n M? ?params.yaml|M params.yaml"):
        run(pretended, ONE)
    assert pretended.queued == []


def test_a_queue_whose_workers_do_not_start_is_given_up():
    with pytest.raises(CommandError, match="no worker"):
        run(Pretended(starts=False), ONE)


def test_a_status_that_cannot_be_read_for_a_moment_is_asked_again():
    pretended = Pretended(garbled=2)
    assert run(pretended, ONE) == {}
    with pytest.raises(CommandError, match="queue status"):
        run(Pretended(garbled=1000), ONE)


def test_an_interrupt_ends_the_workers_too():
    def interrupt(_):
        raise KeyboardInterrupt

    pretended = Pretended()
    with pytest.raises(KeyboardInterrupt):
        run_missing([ONE], 1, pretended, interrupt)
    assert pretended.said[-1] == ("dvc", "queue", "stop", "--kill")
