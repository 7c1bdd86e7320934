"""Tracker and predictor tuned together, on every set of the paper: which experiments, and the table of what came."""

from collections.abc import Mapping, Sequence
from typing import Any

from experiments.markdown import line, number
from experiments.records import Experiment, Result, about, on_one_set
from experiments.spread import Row

PREDICTOR = "dispnet"
"""The paper's own."""
FIGURES = {
    "detections_px": ("detections px", "trackers", "unsupervised_unrefined", "mean_px"),
    "track_px": ("tracks px", "trackers", "unsupervised", "mean_px"),
    "T_px": ("at T px", "predictors", "tracks", "error_T_px"),
    "2T_px": ("at 2T px", "predictors", "tracks", "error_2T_px"),
}
"""Figure to its words, its file in metrics/, the row or block there before tuning, and its key in that row."""
HEAD = f"""# Tracker and predictor tuned together

From docs/results/finetuned.json. `{PREDICTOR}` and the tracker's detector learn on together, without labels
(`run.finetuned`; docs/pipeline.md says how). "kept": whether no figure that is known without labels got worse; where
one did, the former two stay. That looks at detections, and the tracks, moved from them to the objects' middles, may
still get a little worse. Errors on test clips, before and after: of detections, of tracks, of forecasts from those.
"""


def experiments(names: Sequence[str], datasets: Mapping[str, Any], seed: int) -> dict[str, Experiment]:
    """Data set to its experiment, in the order to run."""
    return {
        name: Experiment(
            f"finetuned-{name}-{PREDICTOR}-seed{seed}",
            on_one_set(name, seed, "simulate" in datasets[name], PREDICTOR, finetuned=True),
            "predictors",
        )
        for name in names
    }


def of_trackers(experiment: Experiment) -> Experiment:
    """The same experiment, for what it says of trackers."""
    return experiment._replace(measured="trackers")


def collect(wanted: Mapping[str, Experiment], results: Mapping[Experiment, Result], seed: int) -> dict[str, Row]:
    """Data set to `kept` and each of FIGURES, `_before` and `_after`; with commit, seeds, machine, time_s, finished."""
    table = {}
    for name, experiment in wanted.items():
        if experiment in results and of_trackers(experiment) in results:
            found = {"predictors": results[experiment], "trackers": results[of_trackers(experiment)]}
            rows = {key: each.figures[name] for key, each in found.items()}
            table[name] = _row(rows) | about({seed: results[experiment]})
    return table


def _row(rows: Mapping[str, Mapping[str, Any]]) -> Row:
    kept = rows["predictors"]["tuning"][PREDICTOR]["gained"]
    row: Row = {"kept": kept}
    for figure, (_, file, name, key) in FIGURES.items():
        block = rows[file]
        old = block[name] if file == "trackers" else block[name][PREDICTOR]
        new = old if not kept else _tuned(block, name, file)
        row |= {f"{figure}_before": old[key], f"{figure}_after": new[key]}
    return row


def _tuned(block: Mapping[str, Any], name: str, file: str) -> Mapping[str, Any]:
    row: Mapping[str, Any] = block[f"{name}_with_{PREDICTOR}"] if file == "trackers" else block["tuned"][PREDICTOR]
    return row


def page(table: Mapping[str, Row], names: Sequence[str]) -> str:
    """The table, and which of the sets `names` have not run."""
    heads = [head for words, *_ in FIGURES.values() for head in (f"{words} before", "after")]
    columns = ["set", "kept", *heads, "commit"]
    rows = [line([f"`{name}`", number(row["kept"]), *_cells(row), row["commit"]]) for name, row in table.items()]
    lacking = [f"`{name}`" for name in names if name not in table]
    told = [gained(table), f"Not run yet: {', '.join(lacking)}.\n"] if lacking else [gained(table)]
    shown = [line(columns) + line(["---", "---", *["---:"] * len(heads), "---"]) + "".join(rows)] if rows else []
    return "\n".join([HEAD, *shown, *told])


def gained(table: Mapping[str, Row]) -> str:
    """In how many sets the tuned pair was kept, and what each figure won or lost by it there."""
    kept = {name: row for name, row in table.items() if row["kept"]}
    changes = [
        f"{words} {', '.join(f'{change:+.3f} (`{name}`)' for name, change in known.items())}"
        for figure, (words, *_) in FIGURES.items()
        if (known := _changes(kept, figure))
    ]
    told = f"Kept on {len(kept)} of {len(table)} sets."
    return f"{told} What that changed, less being better: {'; '.join(changes)}.\n" if changes else f"{told}\n"


def _changes(kept: Mapping[str, Row], figure: str) -> dict[str, float]:
    pairs = {name: (row[f"{figure}_before"], row[f"{figure}_after"]) for name, row in kept.items()}
    return {name: after - before for name, (before, after) in pairs.items() if None not in (before, after)}


def _cells(row: Row) -> list[str]:
    return [number(row[f"{figure}_{when}"]) for figure in FIGURES for when in ("before", "after")]
