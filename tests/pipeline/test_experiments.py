"""An experiment through DVC's own queue, on the tiny project."""

import json


def test_results_come_through_the_queue_and_are_not_made_twice(project):
    words = ("python", "-m", "experiments.results", "--sets", "bowls", "--recipes", "joint", "--seeds", "0")
    assert "success results-bowls-joint-seed0" in project.run(*words)
    rows = json.loads((project.root / "docs/results/trackers.json").read_text())["bowls"]
    known = json.loads((project.root / "metrics/trackers.json").read_text())["bowls"]
    assert rows.keys() == {name.replace("unsupervised", "unsupervised_joint") for name in known}
    assert {key: rows["lab"][key] for key in known["lab"]} == known["lab"]  # no seed changes what learns nothing
    assert rows["unsupervised_joint"]["seeds"] == [0]
    commit, code = rows["unsupervised_joint"]["commit"], ("physpipe/tracknet", "stages", "dvc.yaml", "params.yaml")
    assert not project.run("git", "diff", "--name-only", commit, "HEAD", "--", *code).strip()
    assert project.run("git", "show", "--name-only", "--format=", commit, "--", "physpipe", *code).strip()
    assert "`unsupervised_joint`" in (project.root / "docs/results.md").read_text()
    assert "queueing" not in project.run(*words)
