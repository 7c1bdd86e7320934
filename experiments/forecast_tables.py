"""The tables of forecasts in docs/results.md."""

from collections.abc import Collection, Mapping

from scipy.stats import binom

from experiments.markdown import Columns, columns_with_figures, line, number
from experiments.spread import Row
from experiments.tracker_runs import Table

LEARNED_FROM = {"tracks": "unsupervised tracks", "truth": "true positions"}
EXTRAPOLATION: Columns = {
    "error_T_px": "at T px",
    "paper_error_T_px": "paper",
    "error_2T_px": "at 2T px",
    "paper_error_2T_px": "paper",
    "error_4T_px": "at 4T px",
    "error_T_px_before_collision": "at T before a collision",
    "error_T_px_after_collision": "after",
    "frames_to_radius": "frames to a radius",
    "coverage_90_T": "90 % hold at T",
    "coverage_90_2T": "at 2T",
    "energy_drift_2T": "energy drift at 2T",
    "energy_off_2T": "its size",
    "nll_bits": "bits at T",
    "paper_nll_bits": "paper",
}
FRAMES = (10, 20, 30, 40)
"""Of the paper's tables that compare extrapolation with interpolation."""
INTERPOLATION: Columns = {
    f"{whose}error_{frame}_px": head
    for frame in FRAMES
    for whose, head in (("", f"at frame {frame} px"), ("paper_", "paper"))
}
TO_THE_END = ("dispnet_long", "interpnet")
"""Predictors of those tables."""
HEAD = """# Forecasts

From docs/results/predictors.json. Error of the forecast from the first four frames (six for `vin`), in pixels of a
128-px frame, on test clips; T is the set's `predict.horizon`, the last frame learned. `dispnet_long` learned to
`predict.interpolation`; `interpnet` also sees the frame there, not the positions in it. `terrain` is ours; it also
learns from as many clips as the `full` size of a set has (`simulate.size`), in a section that is named so. "frames to
a radius": the median, until the error exceeds the ball's radius. "90 % hold": the share of true positions within the
ellipse that should hold 90 %; what gives none of its own has a circle, fitted to how far it missed the validation
clips (rows of earlier commits have none). "Energy drift": what a forecast wins (+) or loses (-) that the simulated
balls did not, as a share of their energy where it begins.
"""


def page(table: Mapping[str, Table], grid: Mapping[str, Mapping[str, Collection[str]]]) -> str:
    """A section a data set; `grid`, data set to predictor to what it should learn from, tells what has not run."""
    names = [*grid, *(name for name in table if name not in grid)]
    return "\n".join([HEAD, *(_section(name, table.get(name, {}), grid.get(name, {})) for name in names)])


def _section(name: str, blocks: Table, wanted: Mapping[str, Collection[str]]) -> str:
    rows = [(predictor, source, row) for source in LEARNED_FROM for predictor, row in _ranked(blocks.get(source, {}))]
    lacking = [
        each for each, sources in wanted.items() if any(each not in blocks.get(source, ()) for source in sources)
    ]
    parts = [f"## Forecasts on {name}\n"]
    if lacking:
        parts.append(f"Not run yet: {', '.join(f'`{each}`' for each in lacking)}.\n")
    if not rows:
        return "\n".join(parts)
    parts.append(_told([row for *_, row in rows]) + "\n")
    parts.append(_table([each for each in rows if each[0] not in TO_THE_END], EXTRAPOLATION))
    to_the_end = [each for each in rows if each[0] in TO_THE_END]
    if to_the_end:
        parts.append(_table(to_the_end, INTERPOLATION))
    return "\n".join(parts)


def _told(rows: list[Row]) -> str:
    seeds = sorted({seed for row in rows for seed in row["seeds"]})
    commits = sorted({row["commit"] for row in rows})
    machines = " and ".join(sorted({row["machine"] for row in rows}))
    finished = max(row["finished"] for row in rows)
    told = f"Seeds {', '.join(map(str, seeds))}; commit {', '.join(commits)}; {machines}; {finished[:10]}."
    return f"{told} {_luck(min(row['clips'] for row in rows))}"


def _luck(clips: int) -> str:
    """What coverage of 90 % may look like in so few clips; those of two objects in a clip are hardly independent."""
    low, high = binom.interval(0.95, clips, 0.9)
    return f"Of {clips} clips, ellipses that do hold 90 % hold {low / clips:.2f} to {high / clips:.2f} 19 times in 20."


def _table(rows: list[tuple[str, str, Row]], columns: Columns) -> str:
    shown = columns_with_figures(columns, [row for *_, row in rows])
    lines = [line(["predictor", "learned from", *shown.values()]), line(["---", "---", *["---:"] * len(shown)])]
    lines += [
        line([f"`{name}`", LEARNED_FROM[source], *(number(row.get(key)) for key in shown)])
        for name, source, row in rows
    ]
    return "".join(lines)


def _ranked(block: Mapping[str, Row]) -> list[tuple[str, Row]]:
    """Best first."""
    return sorted(block.items(), key=lambda each: each[1].get("error_T_px") or float("inf"))
