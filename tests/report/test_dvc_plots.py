"""The page of `dvc plots diff` in a real browser without a network: two commits, all models, nothing fetched."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pandas as pd
import pytest
import yaml
from playwright.sync_api import Page, expect, sync_playwright

from physpipe.report.glossary import LOSSES

ROOT = Path(__file__).parents[2]
SIDES = """ticks => ticks.map((tick) => {
    const { left, right } = tick.getBoundingClientRect();
    return [left, right, getComputedStyle(tick).opacity !== "0"];
})"""
FADED = "[stroke-opacity='0.08']"
expect.set_options(timeout=30_000)  # a busy machine is slow, not wrong


def run(folder: Path, *words: str) -> None:
    """Runs git or the `dvc` beside this Python, as nobody's shell has set them up."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("DVC_", "GIT_"))}
    names = {
        f"GIT_{who}_{what}": "test@example.invalid" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")
    }
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**plain, **names, "PATH": path, "DVC_NO_ANALYTICS": "1"}
    subprocess.run(words, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def plots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page that compares the project's curves with a commit in which every dispnet erred twice as far."""
    project = tmp_path_factory.mktemp("plots") / "project"
    shutil.copytree(ROOT / "metrics", project / "metrics")
    (project / ".dvc").mkdir()
    shutil.copy(ROOT / ".dvc" / "config", project / ".dvc")
    plots = yaml.safe_load((ROOT / "dvc.yaml").read_text())["plots"]
    (project / "dvc.yaml").write_text(yaml.safe_dump({"plots": plots}))
    path = project / "metrics" / "curves.csv"
    now = pd.read_csv(path)
    factor = now["predictor"].map({"dispnet": 2.0}).fillna(1.0)
    run(project, "git", "init", "-q")
    for curves in (now.assign(error_px=factor * now["error_px"]), now):
        curves.to_csv(path, index=False)
        run(project, "git", "add", "--all")
        run(project, "git", "commit", "-qm", "results")
    run(project, "dvc", "plots", "diff", "HEAD~1", "HEAD")
    return project / "dvc_plots" / "index.html"


@pytest.fixture
def page(plots: Path, chromium: str) -> Iterator[Page]:
    """The page from disk; anything on the console and requests for anything outside it fail the test."""
    wrong: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_context(offline=True).new_page()
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda asked: None if asked.url.startswith(("file:", "data:")) else wrong.append(asked.url))
        page.goto(plots.as_uri())
        yield page
        browser.close()
    assert wrong == []


def test_plots_of_two_commits_are_drawn_without_a_network(page):
    curves = pd.read_csv(ROOT / "metrics" / "curves.csv")
    charts = page.locator(".vega-embed")
    expect(charts).to_have_count(3)
    horizons = charts.nth(0)
    for words in ("mean error in px", "frame (first seen = 0)", "trained on unsupervised tracks", "HEAD~1", "HEAD"):
        expect(horizons.locator("svg.marks").get_by_text(words, exact=True).first).to_be_visible()
    for name in {*curves["dataset"], *curves["predictor"]}:
        expect(horizons.locator("svg.marks").get_by_text(name, exact=True).first).to_be_visible()
    lines = horizons.locator(".mark-line path")
    expect(lines).to_have_count(2 * len(curves[["dataset", "supervision", "predictor"]].drop_duplicates()))
    panels = len(curves[["dataset", "supervision"]].drop_duplicates())  # none without a curve
    expect(horizons.locator(".concat_0_cell > g")).to_have_count(panels)
    expect(horizons.locator("[aria-label^='X-axis']")).to_have_count(panels)
    dashes = {line.get_attribute("stroke-dasharray") or "" for line in lines.all()}
    assert len(dashes) == 2  # a commit a style
    expect(charts.nth(1).locator("svg.marks").get_by_text("share of frames").first).to_be_visible()
    expect(charts.nth(2).locator(".mark-line path").first).to_be_attached()


def test_learning_curves_have_words_and_ticks_that_stand_apart(page):
    learning = page.locator(".vega-embed").nth(2)
    expect(learning.locator(".mark-line path").first).to_be_attached()
    losses = pd.read_csv(ROOT / "metrics" / "learning.csv")["loss"].unique()
    told = " ".join(learning.locator(".role-header-label, .role-title, .role-column-header").all_text_contents())
    for loss in losses:
        assert LOSSES[loss] in told
        assert "_" not in LOSSES[loss]
    axes = learning.locator(".role-axis:has-text('step') .role-axis-label").all()
    assert len(axes) > len(losses)  # a panel a data set, too
    for axis in axes:
        ticks = axis.locator("text").evaluate_all(SIDES)
        ticks = sorted((left, right) for left, right, seen in ticks if seen)
        assert len(ticks) > 1
        assert all(right + 4 <= left for (_, right), (left, _) in pairwise(ticks))  # px


def test_a_pressed_name_leaves_its_model_alone(page):
    horizons = page.locator(".vega-embed").nth(0)
    expect(horizons.locator(".mark-line path").first).to_be_attached()
    expect(horizons.locator(f".mark-line path{FADED}")).to_have_count(0)
    drawn = pd.read_csv(ROOT / "metrics" / "curves.csv")[["dataset", "supervision", "predictor"]].drop_duplicates()
    horizons.locator("[aria-roledescription=circle][aria-label*='predictor: dispnet']").click()
    others = drawn["predictor"] != "dispnet"
    expect(horizons.locator(f".mark-line path{FADED}")).to_have_count(2 * int(others.sum()))
