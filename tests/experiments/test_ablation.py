"""The ablation's variants, and what is made of their results."""

from pathlib import Path

import pytest
from dvc.utils.hydra import apply_overrides

from experiments.ablation import choice, collect, experiments
from experiments.ablation_chart import draw
from experiments.records import Result
from experiments.variants import variants
from physpipe.core.params import read
from physpipe.tracker_learning.recipe import TrackerParams

PARAMS = Path(__file__).parents[2] / "params.yaml"
SEEDS = [0, 1]


def result(mean_px: float) -> Result:
    rows = {
        name: {"mean_px": mean_px, "p99_px": 2 * mean_px, "off_track": 0.0}
        for name in ("unsupervised_unrefined", "centre")
    }
    rows["unsupervised_unrefined"]["locked"] = mean_px < 10
    return Result({"bowls": rows}, "abc1234", "2026-01-02T03:04:05+00:00", "here", 9.0)


def test_the_paper_s_seven_combinations_and_every_ingredient_once():
    parts = variants()
    losses = ["disc", "ent", "siam", "disc+ent", "disc+siam", "ent+siam", "disc+ent+siam"]
    assert list(parts["losses"]) == losses
    assert parts["losses"]["disc+ent+siam"] == ("tracker.recipe=sequential",)
    assert parts["losses"]["disc"] == (
        "tracker.recipe=sequential",
        "tracker.recipes.sequential.net.losses.entropy=0",
        "tracker.recipes.sequential.net.losses.equivariance=0",
    )
    assert parts["ingredients"]["full recipe"] == ("tracker.recipe=joint",)
    names = [each.name for each in experiments("bowls", True, SEEDS).values()]
    assert len(names) == len(set(names)) == 2 * (7 + len(parts["ingredients"]))


@pytest.mark.parametrize("row", [(part, row) for part, rows in variants().items() for row in rows])
def test_every_variant_is_a_valid_recipe_and_all_but_the_full_one_differ_from_ours(row, tmp_path):
    copy = tmp_path / "params.yaml"
    copy.write_text(PARAMS.read_text())
    apply_overrides(copy, list(experiments("bowls", True, [0])[*row, 0].overrides))
    varied = read("tracker", TrackerParams, copy)
    ours = read("tracker", TrackerParams, PARAMS).recipes[varied.recipe]
    assert (ours == varied.chosen()) == (row[1] in ("disc+ent+siam", "full recipe"))


def test_rows_are_means_over_seeds_and_a_row_that_lacks_a_seed_is_null(tmp_path):
    wanted = experiments("bowls", True, SEEDS)
    results = {each: result(1.0 + seed) for (_, _, seed), each in wanted.items()}
    del results[wanted["ingredients", "without flicker", 1]]
    parts = collect(wanted, results, "bowls")
    row = parts["losses"]["disc"]
    assert (row["mean_px"], row["p99_px"], row["off_track"], row["locked"]) == (1.5, 3, 0, True)
    assert (row["worst"]["mean_px"], row["commit"], row["seeds"]) == (2, "abc1234", SEEDS)
    assert row["per_seed"]["1"]["mean_px"] == 2
    assert parts["ingredients"]["without flicker"] is None
    assert parts["losses"]["const"]["locked"] is None
    draw(tmp_path / "bars.png", parts)
    assert (tmp_path / "bars.png").stat().st_size > 10_000


def test_the_choice_is_judged_by_the_ranks_of_scores_and_errors():
    runs = [{"score": score, "mean_px": px} for score, px in [(0.1, 1.0), (0.2, 1.5), (0.9, 40.0), (0.3, 1.2)]]
    assert choice(runs) == {"runs": 4, "spearman": 0.8}  # 1 - 6 (0 + 1 + 0 + 1) / (4 * 15)
    assert choice([{"score": None, "mean_px": 1.0}, *runs[:2]]) == {"runs": 2, "spearman": None}


def test_nothing_run_is_all_null_and_still_drawn(tmp_path):
    parts = collect(experiments("bowls", True, SEEDS), {}, "bowls")
    assert set(parts["losses"].values()) == {None}
    draw(tmp_path / "bars.png", parts)
