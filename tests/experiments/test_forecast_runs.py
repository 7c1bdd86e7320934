"""Which predictors run on which sets, and the rows and tables that come of them."""

from pathlib import Path

import yaml

from experiments.forecast_runs import at_full_size, collect, experiments, grid
from experiments.forecast_tables import page
from experiments.records import Result

ROOT = Path(__file__).parents[2]
DATASETS = yaml.safe_load((ROOT / "params.yaml").read_text())["datasets"]
PAPER = yaml.safe_load((ROOT / "physpipe/report/paper.yaml").read_text())
GRID = grid(PAPER, list(DATASETS))
TOLD = {"seeds": [0], "commit": "a", "machine": "m", "finished": "2026-01-02T03", "clips": 33}


def result(error_px: float) -> Result:
    rows = {
        "dispnet": {"error_T_px": error_px, "paper_error_T_px": 3.9, "clips": 33},
        "persistence": {"error_T_px": 33.0, "clips": 33},
    }
    figures = {"bowls": {"calibration": {}, "tracks": rows, "truth": rows}}
    return Result(figures, "abc1234", "2026-01-02T03:04:05+00:00", "here", 60.0)


def test_the_grid_is_the_papers_with_ours_beside_it():
    assert GRID["bowls"].keys() == PAPER["predictors"]["bowls"]["tracks"].keys() | {"terrain"}
    assert GRID["bowls"]["terrain"] == GRID["heights"]["vin"] == ["truth", "tracks"]
    assert GRID["bowls"]["interpnet"] == GRID["poolr_sim"]["terrain"] == ["tracks"]
    assert not {"tray", "heightr2_same_sim"} & GRID.keys()


def test_an_experiment_runs_one_predictor_on_one_set_and_learns_from_truth_where_the_paper_did():
    wanted = experiments(GRID, DATASETS, seed=3)
    on_truth = wanted["bowls", "vin"]
    assert {"run.learned=[vin]", "run.supervised=[bowls]", "compute.seed=3"} <= set(on_truth.overrides)
    assert on_truth.measured == "predictors"
    assert "run.supervised=[]" in wanted["bowlr_sim", "vin"].overrides


def test_ours_also_learns_from_the_full_size_of_a_set_that_has_one():
    full = at_full_size(GRID, DATASETS)
    assert full == {"heights_full": {"terrain": GRID["heights"]["terrain"]}}
    wanted = experiments(GRID | full, DATASETS, seed=0)
    larger, default = wanted["heights_full", "terrain"], wanted["heights", "terrain"]
    assert {*larger.overrides} - {*default.overrides} == {"datasets.heights.simulate.size=full"}
    figures = {"heights": {"tracks": {"terrain": {"error_T_px": 5.0, "clips": 160}}}}
    found = {larger: Result(figures, "abc1234", "2026-01-02T03:04:05+00:00", "here", 60.0)}
    assert collect(wanted, found, seed=0)["heights_full"]["tracks"]["terrain"]["error_T_px"] == 5


def test_rows_are_told_apart_by_what_was_learned_from_and_the_others_are_in_once():
    wanted = experiments(GRID, DATASETS, seed=0)
    found = {wanted["bowls", "dispnet"]: result(4.0), wanted["bowls", "terrain"]: result(5.0)}
    table = collect(wanted, found, seed=0)
    assert table.keys() == {"bowls"}
    row = table["bowls"]["tracks"]["dispnet"]
    assert (row["error_T_px"], row["commit"], row["seeds"], row["time_s"]) == (4, "abc1234", [0], 60)
    assert table["bowls"]["truth"].keys() == {"dispnet", "persistence"}


def test_the_page_has_the_papers_figures_beside_ours_and_names_what_has_not_run():
    wanted = experiments(GRID, DATASETS, seed=0)
    lines = page(collect(wanted, {wanted["bowls", "dispnet"]: result(4.0)}, seed=0), GRID).splitlines()
    assert "| predictor | learned from | at T px | paper | s | commit |" in lines
    assert "| `dispnet` | unsupervised tracks | 4.00 | 3.90 | 60.00 | abc1234 |" in lines
    assert "| `persistence` | true positions | 33.00 | – | 60.00 | abc1234 |" in lines
    lacking = lines[lines.index("## Forecasts on bowls") + 2]
    assert lacking.startswith("Not run yet: `ifs`, `vin`")
    assert "`dispnet`" not in lacking
    assert "## Forecasts on heightr2_sim" in lines


def test_the_page_names_what_errs_least_beside_the_paper_and_what_stands_still():
    net = {
        "error_T_px": 4.0,
        "error_T_px_low": 3.0,
        "error_T_px_high": 5.0,
        "paper_error_T_px": 3.9,
        "error_2T_px": 9.0,
    }
    still = {"error_T_px": 33.0, "error_2T_px": 8.0}
    text = page({"bowls": {"tracks": {"dispnet": {**net, **TOLD}, "persistence": {**still, **TOLD}}}}, {})
    assert "| `dispnet` | unsupervised tracks | 4.00 [3.00–5.00] |" in text
    learned = "learned from unsupervised tracks:"
    assert f"Least at T, {learned} 4.00 px of `dispnet`, 3.90 px in the paper, 33.00 px by standing still." in text
    assert f"Least at 2T, {learned} 8.00 px of `persistence`." in text


def test_how_sure_a_forecast_is_has_a_table_of_those_that_say_it():
    row = {"error_T_px": 1.0, "coverage_90_T": 0.9, "coverage_90": 0.8, "nll_bits": 6.0, "paper_nll_bits": 6.3}
    text = page({"bowls": {"tracks": {"probnet": {**row, **TOLD}, "linear": {"error_T_px": 9.0, **TOLD}}}}, {})
    sure = text[text.index("90 % hold at T |") :]
    assert "| `probnet` | unsupervised tracks | 0.90 | 0.80 | 6.00 | 6.30 |" in sure
    assert "`linear`" not in sure


def test_interpolation_has_a_table_of_its_own():
    row = {"error_10_px": 1.5, "paper_error_10_px": 3.8, "error_T_px": 1.0, **TOLD}
    text = page({"bowls": {"tracks": {"interpnet": row}}}, {})
    assert "| `interpnet` | unsupervised tracks | 1.50 | 3.80 | a |" in text.splitlines()


def test_the_page_says_what_coverage_so_few_clips_can_tell_apart():
    """Of 33 clips 26 to 33 lie within ellipses that hold 90 %, by the binomial law: 19 times in 20."""
    text = page({"bowls": {"tracks": {"terrain": {"error_T_px": 1.0, **TOLD}}}}, {})
    assert "Of 33 clips, ellipses that do hold 90 % hold 0.79 to 1.00 19 times in 20." in text
