"""What is queued, what is skipped, what is said of failures: against a DVC and a Git that only pretend."""

import json

import pytest

from experiments import queue
from experiments.queue import CommandError, Experiment, read_results, run_missing, tracker_only

BASE, OLD = "a" * 40, "b" * 40
ONE, TWO = Experiment("one", ("x=1",)), Experiment("two", ("x=2", "y=[]"))
TRACKERS = {"bowls": {"unsupervised": {"mean_px": 0.5}}}


class Pretended:
    """Answers as git and dvc would; a task runs for one poll, then succeeds unless its label is in `broken`."""

    def __init__(self, finished=(), broken=(), changed="", tasks=(), workers=0, starts=True):
        self.refs = [(name, base) for name, base in finished]
        self.broken, self.changed, self.starts = broken, changed, starts
        self.tasks, self.workers = list(tasks), workers
        self.said: list[tuple[str, ...]] = []

    def __call__(self, *words: str) -> str:
        self.said.append(words)
        answers = {
            ("git", "status"): lambda: self.changed,
            ("git", "for-each-ref"): self._refs,
            ("git", "diff"): lambda: "physpipe/core/ball.py" if words[3] == OLD else "",
            ("git", "show"): lambda: self._show(words[-1]),
            ("dvc", "exp"): lambda: self._queue(words),
            ("dvc", "queue"): lambda: self._manage(words[2:]),
        }
        return answers[words[:2]]()

    def _refs(self):
        lines = [f"{'1' * 40} refs/exps/{base[:2]}/{base[2:]}/{name}" for name, base in self.refs]
        return "\n".join([*lines, f"{'2' * 40} refs/exps/celery/stash"])

    def _show(self, what):
        return json.dumps(TRACKERS) if ":" in what else f"{BASE[:7]} 2026-01-02T03:04:05+00:00\n"

    def _queue(self, words):
        self.tasks.append([f"{len(self.tasks):07x}", words[words.index("--name") + 1], "Queued"])
        return ""

    def _manage(self, words):
        if words[0] == "start":
            self.workers = int(self.starts)
        if words[0] == "remove":
            self.tasks = [task for task in self.tasks if task[0] not in words]
        if words[0] == "logs":
            return "step 1\nerror: params.yaml: bad. To mend: mend it.\nERROR: failed to reproduce\n\n"
        if words[0] == "status":
            rows = "\n".join(f"{task}  {name}  04:03 AM   {state}" for task, name, state in self.tasks)
            self._advance()
            return f"Task  Name  Created  Status\n{rows}\n\nWorker status: {self.workers} active, 0 idle\n"
        return ""

    def _advance(self):
        for task in self.tasks if self.workers else []:
            if task[2] == "Running":
                task[2] = "Failed" if task[1].rsplit("-", 1)[0] in self.broken else "Success"
                self.refs += [(task[1], BASE)] if task[2] == "Success" else []
            elif task[2] == "Queued":
                task[2] = "Running"

    @property
    def queued(self) -> list[tuple[str, ...]]:
        return [words for words in self.said if words[:2] == ("dvc", "exp")]


@pytest.fixture(autouse=True)
def costs(tmp_path, monkeypatch):
    monkeypatch.setattr(queue, "COSTS", tmp_path / "costs")
    return tmp_path / "costs"


def run(pretended: Pretended, *wanted: Experiment) -> dict[Experiment, str]:
    return run_missing(wanted, jobs=2, run=pretended, wait=lambda _: None)


def test_an_experiment_s_name_tells_its_overrides_apart():
    assert ONE.name.startswith("one-")
    assert ONE.name == Experiment("one", ("x=1",)).name
    assert len({ONE.name, Experiment("one", ("x=2",)).name, Experiment("one", ("x=1", "y=1")).name}) == 3


def test_all_that_is_missing_is_queued_in_order_with_its_overrides():
    pretended = Pretended()
    assert run(pretended, ONE, TWO) == {}
    head = ("dvc", "exp", "run", "--queue", "--name")
    assert pretended.queued == [(*head, ONE.name, "-S", "x=1"), (*head, TWO.name, "-S", "x=2", "-S", "y=[]")]
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


def test_an_interrupt_ends_the_workers_too():
    def interrupt(_):
        raise KeyboardInterrupt

    pretended = Pretended()
    with pytest.raises(KeyboardInterrupt):
        run_missing([ONE], 1, pretended, interrupt)
    assert pretended.said[-1] == ("dvc", "queue", "stop", "--kill")


def test_results_carry_commit_date_machine_and_time():
    pretended = Pretended()
    run(pretended, ONE)
    here = read_results([ONE, TWO], pretended)[ONE]
    assert (here.trackers, here.commit, here.finished) == (TRACKERS, BASE[:7], "2026-01-02T03:04:05+00:00")
    assert here.machine == queue.machine()
    assert here.time_s is not None
    elsewhere = read_results([TWO], Pretended(finished=[(TWO.name, BASE)]))[TWO]
    assert (elsewhere.machine, elsewhere.time_s) == (None, None)


def test_only_one_data_set_s_trackers_are_left_to_run():
    assert "run.simulated=[bowls]" in tracker_only("bowls", 1, simulated=True)
    film = tracker_only("tray", 2, simulated=False)
    assert {"run.datasets=[tray]", "run.simulated=[]", "run.learned=[]", "compute.seed=2"} <= set(film)


def test_a_command_that_fails_says_why():
    with pytest.raises(CommandError, match="git no-such-command"):
        queue.command("git", "no-such-command")
