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
    "ade_px": "mean to T px",
    "skill_T": "skill at T",
    "error_T_px_before_collision": "at T before a collision",
    "error_T_px_after_collision": "after",
    "frames_to_radius": "frames to a radius",
    "energy_drift_2T": "energy drift at 2T",
    "energy_off_2T": "its size",
    "time_s": "s",
    "commit": "commit",
}
SURENESS: Columns = {
    "coverage_90_T": "90 % hold at T",
    "coverage_90_2T": "at 2T",
    "coverage_90": "over all frames to T",
    "nll_bits": "bits at T",
    "paper_nll_bits": "paper",
    "nll_bits_2T": "bits at 2T",
    "paper_nll_bits_2T": "paper",
}
WITH_INTERVAL = ("error_T_px", "error_2T_px")
STILL = "persistence"
"""What moves nothing, to compare with."""
FRAMES = (10, 20, 30, 40)
"""Of the paper's tables that compare extrapolation with interpolation."""
INTERPOLATION: Columns = {
    f"{whose}error_{frame}_px": head
    for frame in FRAMES
    for whose, head in (("", f"at frame {frame} px"), ("paper_", "paper"))
} | {"time_s": "s", "commit": "commit"}
TO_THE_END = ("dispnet_long", "interpnet")
"""Predictors of those tables."""
HEAD = """# Forecasts

From docs/results/predictors.json, which holds more. Error of the forecast from the first four frames (six for `vin`),
in pixels of a 128-px frame, on test clips, with the 95 % interval over clips in brackets; T is the set's
`predict.horizon`, the last frame learned. `dispnet_long` learned to `predict.interpolation`; `interpnet` also sees the
frame there, not the positions in it. The paper gives `ifs` velocities on simulated sets alone, and the bowls' axes
where it learns from truth; here it has velocities on every set, axes on none. `terrain` is ours; it also learns from as
many clips as the `full` size of a set has (`simulate.size`), in a section that is named so. "Skill": what share of the
error of standing still a forecast spares. "Frames to a radius": the median, until the error exceeds the ball's radius.
"Energy drift": what a forecast wins (+) or loses (-) that the simulated balls did not, as a share of their energy where
it begins. "s": all that ran for the row, stages that DVC's cache held taking none. Rows of an earlier commit stand
until they are measured again.

"90 % hold": the share of true positions within the ellipse that should hold 90 %; what gives none of its own has a
circle, fitted to how far it missed the validation clips (rows of earlier commits have none). "Bits": the mean negative
log2 of the density at the true position, the exponent of what the paper calls perplexity.
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
    onwards = [each for each in rows if each[0] not in TO_THE_END]
    parts += [_table(onwards, EXTRAPOLATION), verdict(blocks.get("tracks", {}))]
    sure = [each for each in onwards if each[2].get("coverage_90_T") is not None]
    if sure:
        parts.append(_table(sure, SURENESS))
    to_the_end = [each for each in rows if each[0] in TO_THE_END]
    if to_the_end:
        parts.append(_table(to_the_end, INTERPOLATION))
    return "\n".join(parts)


def verdict(block: Mapping[str, Row]) -> str:
    """Whose error is least at T and at 2T, beside the least that the paper prints and that of standing still."""
    rows = {name: row for name, row in block.items() if name not in TO_THE_END}
    return "".join(f"{sentence}\n" for when in ("T", "2T") if (sentence := _least(rows, when)))


def _least(rows: Mapping[str, Row], when: str) -> str:
    key = f"error_{when}_px"
    known = {name: row[key] for name, row in rows.items() if row.get(key) is not None}
    printed = [row[f"paper_{key}"] for row in rows.values() if row.get(f"paper_{key}") is not None]
    if not known:
        return ""
    best = min(known, key=lambda name: known[name])
    told = [f"{number(known[best])} px of `{best}`"]
    told += [f"{number(min(printed))} px in the paper"] if printed else []
    told += [f"{number(known[STILL])} px by standing still"] if STILL in known and best != STILL else []
    return f"Least at {when}, learned from {LEARNED_FROM['tracks']}: {', '.join(told)}."


def _told(rows: list[Row]) -> str:
    seeds = sorted({seed for row in rows for seed in row["seeds"]})
    machines = " and ".join(sorted({row["machine"] for row in rows}))
    finished = max(row["finished"] for row in rows)
    told = f"Seeds {', '.join(map(str, seeds))}; {machines}; {finished[:10]}."
    return f"{told} {_luck(min(row['clips'] for row in rows))}"


def _luck(clips: int) -> str:
    """What coverage of 90 % may look like in so few clips; those of two objects in a clip are hardly independent."""
    low, high = binom.interval(0.95, clips, 0.9)
    return f"Of {clips} clips, ellipses that do hold 90 % hold {low / clips:.2f} to {high / clips:.2f} 19 times in 20."


def _table(rows: list[tuple[str, str, Row]], columns: Columns) -> str:
    shown = columns_with_figures(columns, [row for *_, row in rows])
    lines = [line(["predictor", "learned from", *shown.values()]), line(["---", "---", *["---:"] * len(shown)])]
    lines += [
        line([f"`{name}`", LEARNED_FROM[source], *(_cell(key, row) for key in shown)]) for name, source, row in rows
    ]
    return "".join(lines)


def _cell(key: str, row: Row) -> str:
    if key == "commit":
        return str(row.get(key, "–"))
    interval = key in WITH_INTERVAL and row.get(f"{key}_low") is not None
    return number(row.get(key)) + (f" [{number(row[f'{key}_low'])}–{number(row[f'{key}_high'])}]" if interval else "")


def _ranked(block: Mapping[str, Row]) -> list[tuple[str, Row]]:
    """Best first."""
    return sorted(block.items(), key=lambda each: each[1].get("error_T_px") or float("inf"))
