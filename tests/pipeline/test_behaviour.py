"""What re-runs when, on a tiny world, by really running it."""

import json
import os
import signal
import time

import pytest

TRACKING = {"train_tracker@bowls", "mask_objects@bowls"}
PREDICTOR = {"train_predictor@bowls-dispnet", "train_supervised@bowls-dispnet"}


def edit(path, comment: str) -> None:
    path.write_text(path.read_text() + f"\n# {comment}\n")


def test_a_second_repro_runs_nothing(project):
    assert project.repro() == set()


def test_the_page_is_small_enough_to_send(reproduced):
    page, sets = reproduced.root / "report" / "index.html", 9
    assert page.stat().st_size < 15_000_000 / sets  # bytes: a mail takes the page of all sets


def test_film_that_a_user_adds_stays_when_dvc_checks_out(project):
    film = project.root / "data/raw/marbles/roll.mp4"
    film.parent.mkdir()
    film.write_bytes(b"film")
    project.run("dvc", "add", "-q", "data/raw/marbles")
    project.run("dvc", "checkout", "-q")
    assert film.read_bytes() == b"film"
    assert "marbles/" not in project.run("git", "status", "--porcelain", "--untracked-files=all")


def test_a_tracker_loss_weight_re_runs_the_tracker_and_not_ingest(project):
    project.write({"tracker.recipes.joint.net.losses.entropy": 0.02})
    ran = project.repro()
    assert ran >= TRACKING | {"export_tracks@bowls", "train_predictor@bowls-dispnet", "report"}
    assert not ran & {"simulate@bowls", "ingest@bowls", "ground_truth@bowls", "train_supervised@bowls-dispnet"}


@pytest.fixture(scope="module")
def slower(reproduced, tmp_path_factory):
    """The project with another learning rate, reproduced and committed, and the names of the stages that ran."""
    project = reproduced.copied(tmp_path_factory.mktemp("slower"))
    project.write({"predictors.dispnet.fit.learning_rate": 0.001})
    ran = project.repro()
    project.commit("a slower predictor")
    return project, ran


def test_a_predictor_s_params_re_run_that_predictor_only(slower):
    _, ran = slower
    assert ran >= PREDICTOR | {"forecast@bowls-dispnet", "report"}
    assert not ran & (TRACKING | {"ingest@bowls", "baseline_forecasts@bowls", "evaluate_trackers@bowls"})


def test_metrics_and_plots_of_two_commits_compare(slower):
    project, _ = slower
    assert "bowls_T_px" in project.run("dvc", "metrics", "diff", "HEAD~1")
    project.run("dvc", "plots", "diff", "HEAD~1", "HEAD")
    page = (project.root / "dvc_plots/index.html").read_text()
    assert "mean error in px" in page
    assert '"rev": "HEAD~1"' in page
    assert "cdn.jsdelivr.net" not in page  # opens without a network


def test_predictor_code_re_runs_no_tracker_and_the_same_weights_stop_the_wave(project):
    edit(project.root / "physpipe/predictors/dispnet.py", "a remark")
    ran = project.repro()
    assert ran >= PREDICTOR
    assert not ran & (TRACKING | {"ingest@bowls", "report"})


def test_learned_flow_runs_when_asked_for_and_leaves_no_row_when_no_longer(project):
    scores = project.root / "data/scores/bowls/trackers.json"
    before = scores.read_bytes()
    project.write({"run.flow": ["corrflow"]})
    assert project.repro() == {"train_flow@corrflow", "flow_tracks@bowls-corrflow", "evaluate_trackers@bowls", "report"}
    assert project.repro() == set()
    project.write({"run.flow": []})
    assert not project.repro() & {"train_flow@corrflow", "flow_tracks@bowls-corrflow", "baseline_tracks@bowls"}
    assert (project.root / "data/baselines/bowls/corrflow").is_dir()  # what other runs left is not looked at
    assert scores.read_bytes() == before


def test_a_pair_is_tuned_together_when_asked_for_and_its_rows_go_when_no_longer(project):
    before = (project.root / "metrics/trackers.json").read_bytes()
    project.write({"run.finetuned": ["dispnet"]})
    tuning = {"finetune", "finetuned_tracks", "finetuned_forecast", "evaluate_finetuned"}
    assert project.repro() == {*(f"{each}@bowls-dispnet" for each in tuning), "report"}
    figures = {
        each: json.loads((project.root / f"metrics/{each}.json").read_text()) for each in ("trackers", "predictors")
    }
    trackers, predictors = (figures[each]["bowls"] for each in ("trackers", "predictors"))
    gained = predictors["tuning"]["dispnet"]["gained"]
    assert ("unsupervised_with_dispnet" in trackers) == gained
    assert ("tuned" in predictors) == gained
    scored = json.loads((project.root / "data/scores/bowls/finetuned/dispnet.json").read_text())
    assert set(scored["trackers"]) == {"unsupervised_with_dispnet", "unsupervised_unrefined_with_dispnet"}
    assert list(scored["predictors"]) == ["dispnet"]
    assert "Tracker and predictor tuned together" in (project.root / "report/index.html").read_text()
    project.write({"run.finetuned": []})
    assert project.repro() == {"report"}
    assert (project.root / "metrics/trackers.json").read_bytes() == before


def test_two_clean_runs_give_identical_metrics(project):
    before = (project.root / "metrics/summary.json").read_bytes()
    ran = project.repro("--force")
    assert {"simulate@bowls", "train_tracker@bowls", "train_predictor@bowls-dispnet", "report"} <= ran
    assert (project.root / "metrics/summary.json").read_bytes() == before
    assert project.run("git", "status", "--porcelain") == "", "dvc.lock and metrics are those of the first run"


def test_experiments_in_the_workspace_and_in_a_copy_change_what_they_say(project):
    project.run("dvc", "exp", "run", "-n", "rate", "-S", "predictors.dispnet.fit.learning_rate=1e-3")
    assert project.run("git", "diff", "--numstat", "params.yaml") == "1\t1\tparams.yaml\n", "only its line changes"
    project.run("git", "checkout", "-q", ".")
    project.run("dvc", "checkout", "-q")
    project.run("dvc", "exp", "run", "--temp", "-n", "draws", "-S", "evaluate_predictors.bootstrap_resamples=50")
    shown = json.loads(project.run("dvc", "exp", "show", "--json"))
    names = {each["name"] for revision in shown for each in revision.get("experiments") or []}
    assert {"rate", "draws"} <= names
    assert project.run("git", "status", "--porcelain", "--untracked-files=no") == ""


def test_a_training_killed_in_a_repro_resumes_on_the_next_one_to_the_same_weights(project):
    stage, scratch = "train_tracker@bowls", project.root / ".scratch/train_tracker"
    project.write({"compute.seed": 1})
    killed = project.start("dvc", "repro", stage)
    while not list(scratch.glob("*/start0.pt")) and killed.poll() is None:
        time.sleep(0.01)
    os.killpg(killed.pid, signal.SIGKILL)
    killed.wait()
    assert list(scratch.glob("*/start0.pt")), "killed after its first checkpoint"
    assert not (project.root / "data/tracker/bowls/first").exists(), "and before its result"
    assert project.repro(stage) == {stage}
    assert not list(scratch.glob("*")), "checkpoints go when the result is written"
    resumed = (project.root / "dvc.lock").read_bytes()
    assert project.repro("--force", "--single-item", stage) == {stage}
    assert (project.root / "dvc.lock").read_bytes() == resumed, "an undisturbed training gives the same bytes"
