"""The tables of docs/results.md, written from the JSON beside them."""

from collections.abc import Mapping
from typing import Any

from experiments.markdown import Columns, columns_with_figures, line, number
from experiments.spread import Row

OURS = ("unsupervised_joint", "unsupervised")
"""Our trackers, the default recipe's first."""
SHOWN = {"unsupervised": "unsupervised_sequential", "unsupervised_unrefined": "unsupervised_sequential_unrefined"}
"""Keys of rows that go by another name on the page, where every recipe is named."""
LEARNED = ("unsupervised", "flow_")
"""Beginnings of the names of trackers that were trained."""
RUNS = (*OURS, "flow_simple", "flow_blob")
"""A row of each run that a data set takes: missing ones have not been measured."""
NO_TOOLS = ("centre", "persistence")
"""Rows that stand still, to compare with."""
TOLD_STARTS = ("lab", "lucas_kanade", "dis_", "farneback_")
"""Beginnings of the names of tools that are told where each object is when it first shows."""
COLUMNS: Columns = {
    "mean_px": "mean px",
    "paper_mean_px": "paper",
    "var_px2": "variance px²",
    "paper_var_px2": "paper",
    "p99_px": "99 % px",
    "bias_px": "bias px",
    "jitter_px": "jitter px",
    "off_track": "off track",
    "lost": "lost",
    "delta_avg": "δ avg",
    "hota": "HOTA",
    "idf1": "IDF1",
    "idf1_unflagged": "IDF1 unflagged",
    "id_switches": "switches",
    "locked": "locked",
    "frames_per_s": "frames/s",
}
HEAD = """# Results

Written by `make results` from docs/results/trackers.json, which holds more. Mean over seeds, with the worst seed in
brackets where seeds differ; test clips only, in pixels of a 128-px frame. "paper" is the figure printed in Ehrhardt et
al. 2018; for a simulated stand-in, that of the real set. Rows of an earlier commit stand until they are measured again.

Ours are two recipes. `unsupervised_joint`, the default one, finds all objects at once and is told nothing; `metrics/`,
the report and the README call it `unsupervised`. `unsupervised_sequential` (`unsupervised` in the JSON) finds one
object after the other and is told how many there are. `_unrefined` are the same before positions are moved to the
objects' middles. The others learn nothing, but for `flow_*`, whose flow a small network of our own learned from drawn
pairs; all are told how many objects there are. `lab`, `lucas_kanade`, `*_simple` and the `*_blob` of a flow are told
where each object is when it first shows, so they have no choice of an object and no offset from its middle to find;
`trackpy` is told how large it is.
"""


def page(table: Mapping[str, Mapping[str, Row]], unrun: Mapping[str, str], speed: Mapping[str, Any]) -> str:
    """The whole page: a section a data set, then those that have no results with the reason.

    `speed` is what benchmarks/speed.json holds.
    """
    parts = [HEAD]
    if speed["rates"]:
        ours = ", ".join(f"{rate:,.0f} (`{name}`)" for name, rate in speed["all_cores"].items())
        parts.append(f"Frames/s on one thread of {speed['machine']}; ours on its {speed['cores']} cores: {ours}.\n")
    parts += [_section(name, rows) for name, rows in table.items()]
    if unrun:
        parts.append("## Not run\n\n" + "".join(f"- `{name}`: {reason}\n" for name, reason in unrun.items()))
    return "\n".join(parts)


def verdict(rows: Mapping[str, Row]) -> str:
    """Which tool that learns nothing is best in mean and in 99th percentile, what it is told, and whether ours is."""
    tools = {name: row for name, row in rows.items() if not name.startswith(LEARNED) and name not in NO_TOOLS}
    ours = _ours(rows)
    sentences = []
    for key, what in (("mean_px", "mean"), ("p99_px", "99th percentile")):
        known = {name: row[key] for name, row in tools.items() if row.get(key) is not None}
        if not known or ours.get(key) is None:
            continue
        best = min(known, key=lambda name: known[name])
        wins = "ours is as good or better" if ours[key] <= known[best] else f"`{best}` wins{_by_what(best)}"
        figures = f"{number(known[best])} px of `{best}`{_lost(rows[best])} beside {number(ours[key])} px of ours"
        sentences.append(f"In {what} {wins}: {figures}.")
        found = {name: value for name, value in known.items() if not name.startswith(TOLD_STARTS)}
        if best not in found and found:
            near = min(found, key=lambda name: found[name])
            sentences.append(f"Of those told no start `{near}` is best: {number(found[near])} px{_lost(rows[near])}.")
    return " ".join(sentences) or "No tool that learns nothing has errors to compare with."


def _by_what(name: str) -> str:
    return ", which is told where each object first is" if name.startswith(TOLD_STARTS) else ""


def _lost(row: Row) -> str:
    return f" (it lost {row['lost']:.0%} of the frames)" if row.get("lost") else ""


def _section(name: str, rows: Mapping[str, Row]) -> str:
    columns = columns_with_figures(COLUMNS, rows.values())
    order = sorted(rows, key=lambda each: (not each.startswith(LEARNED[0]), _rank(rows[each])))
    lines = [line(["tracker", *columns.values()]), line(["---", *["---:"] * len(columns)])]
    lines += [line([f"`{SHOWN.get(each, each)}`", *(_cell(key, rows[each]) for key in columns)]) for each in order]
    return f"## {name}\n\n{_unrun(rows)}{_measured(rows)}\n\n" + "".join(lines) + f"\n{verdict(rows)}\n"


def _unrun(rows: Mapping[str, Row]) -> str:
    lacking = ", ".join(f"`{SHOWN.get(name, name)}`" for name in RUNS if name not in rows)
    return f"Not run yet: {lacking}.\n\n" if lacking else ""


def _measured(rows: Mapping[str, Row]) -> str:
    """How ours was measured, and which rows were measured with other seeds or by other code."""
    about = _ours(rows) or next(iter(rows.values()))
    time = "" if about["time_s"] is None else f", {about['time_s']:.0f} s the longest seed"
    told = [f"{_run(about)}; {about['machine']}{time}; finished {about['finished'][:10]}."]
    others: dict[str, list[str]] = {}
    for name, row in rows.items():
        if _run(row) != _run(about):
            others.setdefault(_run(row), []).append(f"`{SHOWN.get(name, name)}`")
    told += [f"{run}: {', '.join(names)}." for run, names in others.items()]
    return " ".join(told)


def _run(row: Row) -> str:
    seeds = ", ".join(map(str, row["seeds"]))
    return f"Seed{'s' if len(row['seeds']) > 1 else ''} {seeds}; commit {row['commit']}"


def _ours(rows: Mapping[str, Row]) -> Row:
    return next((rows[name] for name in OURS if name in rows), {})


def _rank(row: Row) -> float:
    return float("inf") if row.get("mean_px") is None else row["mean_px"]


def _cell(key: str, row: Row) -> str:
    """The mean, with the worst seed where it differs, and the interval over clips of the mean error; of a verdict, how
    many seeds have it where they differ.
    """
    if key == "locked":
        return _how_many([each.get(key) for each in row.get("per_seed", {}).values()]) or number(row.get(key))
    value, worst = row.get(key), row.get("worst", {}).get(key)
    text = number(value)
    if key == "mean_px" and row.get("mean_px_low") is not None:
        text += f" [{number(row['mean_px_low'])}–{number(row['mean_px_high'])}]"
    return text if worst is None or number(worst) == number(value) else f"{text} ({number(worst)})"


def _how_many(verdicts: list[bool | None]) -> str | None:
    """`2 of 3`; None where all are alike."""
    return f"{verdicts.count(True)} of {len(verdicts)}" if len(set(verdicts)) > 1 else None
