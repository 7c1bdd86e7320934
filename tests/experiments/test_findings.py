"""Facts about whether the order of the paper's findings holds."""

import yaml
from pages import ROOT

from experiments.findings import FINDINGS, found, page

TENSOR, IFS, VIN = FINDINGS


def row(at_T: float, at_2T: float) -> dict[str, float]:
    return {"error_T_px": at_T, "error_2T_px": at_2T}


def paper_as_table() -> dict[str, dict[str, dict[str, dict[str, float]]]]:
    """The paper's own figures as if they had been measured here."""
    printed = yaml.safe_load((ROOT / "physpipe/report/paper.yaml").read_text())["predictors"]
    return {name: {source: block[source] for source in block} for name, block in printed.items()}


def test_the_best_net_stands_for_all_of_them():
    table = {
        "bowls": {"tracks": {"posnet": row(9, 10), "dispnet": row(4, 20), "ifs": row(8, 16), "linear": row(20, 60)}}
    }
    (answer,) = found(TENSOR, table)
    assert (answer.dataset, answer.source, answer.holds) == ("bowls", "tracks", True)
    assert "nets 4.00 px, `ifs` 8.00 px" in answer.here
    (answer,) = found(IFS, table)
    assert "nets times 5.00, `ifs` times 2.00" in answer.here
    assert answer.holds


def test_what_does_not_hold_is_told():
    table = {
        "heights": {
            "truth": {"vin": row(7, 9), "linear": row(20, 60)},
            "tracks": {"probnet": row(9, 9), "ifs": row(3, 9)},
        }
    }
    assert [answer.holds for answer in found(VIN, table)] == [False]
    assert [answer.holds for answer in found(TENSOR, table)] == [False]
    assert page(table).count("**no**") == 3


def test_a_set_whose_rows_have_not_run_says_nothing():
    table = {"bowls": {"tracks": {"dispnet": row(4, 9), "ifs": {"error_T_px": None}}}}
    assert not list(found(TENSOR, table))
    assert page(table).count("Its rows have not run yet.") == 3


def test_the_papers_own_figures_have_the_papers_order():
    answers = [answer for sentence in FINDINGS for answer in found(sentence, paper_as_table())]
    assert len(answers) >= 4
    assert all(answer.holds for answer in answers)
