"""An experiment through DVC's own queue, on the tiny project."""

import json


def test_results_come_through_the_queue_and_are_not_made_twice(project):
    words = ("python", "-m", "experiments.results", "--sets", "bowls", "--seeds", "0")
    assert "success results-bowls-seed0" in project.run(*words)
    table = json.loads((project.root / "docs/results/trackers.json").read_text())
    ours = json.loads((project.root / "metrics/trackers.json").read_text())["bowls"]["unsupervised"]
    found = table["bowls"]["unsupervised"]
    assert {key: found[key] for key in ours} == ours  # the same seed, the same figures
    assert found["seeds"] == [0]
    assert found["commit"] == project.run("git", "rev-parse", "--short", "HEAD").strip()
    assert "`unsupervised`" in (project.root / "docs/results.md").read_text()
    assert "queueing" not in project.run(*words)
