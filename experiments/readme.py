"""The README's table of results, written from `metrics/`: `make repro` ends with it.

python -m experiments.readme
"""

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from experiments.forecast_tables import LEARNED_FROM
from experiments.markdown import Columns, columns_with_figures, line, number
from experiments.spread import Row
from experiments.tables import NO_TOOLS, OURS

README, METRICS = Path("README.md"), Path("metrics")
BEGIN, END = "<!-- results: written by `make repro` -->\n", "<!-- end of results -->\n"
"""What the tables stand between."""
LEARN_NOTHING = ("linear", "quadratic")
"""Predictors that are left out; `persistence` stays, which stands still."""
STILL = "persistence"
TRACKERS = {"mean_px": "mean px", "paper_mean_px": "paper", "p99_px": "99 % px", "off_track": "off track"}
PREDICTORS = {
    "error_T_px": "at T px",
    "paper_error_T_px": "paper",
    "error_2T_px": "at 2T px",
    "paper_error_2T_px": "paper",
}


def tables(trackers: Mapping[str, Mapping[str, Row]], predictors: Mapping[str, Mapping[str, Any]]) -> str:
    """Two tables of Markdown, from what metrics/trackers.json and metrics/predictors.json hold."""
    followed = list(_trackers(trackers))
    forecast = list(_predictors(predictors))
    return f"\n{_table(['tracker'], TRACKERS | {'locked': 'locked'}, followed)}\n" + (
        f"{_table(['predictor', 'learned from'], PREDICTORS, forecast)}\n"
    )


def _trackers(sets: Mapping[str, Mapping[str, Row]]) -> Iterator[tuple[list[str], Row]]:
    """Ours, and the one that errs least of those that learn nothing, on each data set with truth."""
    for name, rows in sets.items():
        known = {each: row for each, row in rows.items() if row.get("mean_px") is not None}
        tools = [each for each in known if not each.startswith("unsupervised") and each not in NO_TOOLS]
        best = sorted(tools, key=lambda each: rows[each]["mean_px"])[:1]
        for each in [*(ours for ours in OURS if ours in known), *best]:
            yield [name, f"`{each}`"], rows[each]


def _predictors(sets: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[list[str], Row]]:
    for name, blocks in sets.items():
        for supervision, words in LEARNED_FROM.items():
            rows = blocks.get(supervision, {})
            for each in sorted(set(rows) - set(LEARN_NOTHING), key=lambda each: (each == STILL, each)):
                if rows[each].get("error_T_px") is not None:
                    yield [name, f"`{each}`", words], rows[each]


def _table(heads: list[str], columns: Columns, rows: list[tuple[list[str], Row]]) -> str:
    """Columns that no row has a figure for are left out."""
    shown = columns_with_figures(columns, [row for _, row in rows])
    lines = [line(["set", *heads, *shown.values()]), line(["---"] * (1 + len(heads)) + ["---:"] * len(shown))]
    return "".join([*lines, *(line([*names, *(number(row.get(key)) for key in shown)]) for names, row in rows)])


def inserted(text: str, new: str) -> str:
    """`text` with `new` between the two marks; raises ValueError where they are not there once each, in order."""
    if [text.count(mark) for mark in (BEGIN, END)] != [1, 1] or text.index(BEGIN) > text.index(END):
        raise ValueError(f"{README} needs the lines {BEGIN.strip()} and {END.strip()}, in this order, once each")
    return text[: text.index(BEGIN) + len(BEGIN)] + new + text[text.index(END) :]


def from_metrics(folder: Path) -> str:
    """The tables of the metrics files in `folder`."""
    return tables(*(json.loads((folder / f"{name}.json").read_text()) for name in ("trackers", "predictors")))


def main() -> None:
    """Writes the tables into README.md; leaves a file alone that has them already."""
    before = README.read_text(encoding="utf-8")
    try:
        after = inserted(before, from_metrics(METRICS))
    except ValueError as error:
        sys.exit(f"error: {error}")
    if after != before:
        README.write_text(after, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
