"""What `make ablation` measured, as the page shows it."""

from collections.abc import Mapping
from math import log1p
from pathlib import Path
from typing import Any, NamedTuple

from physpipe.core.errors import InputError
from physpipe.io import results
from physpipe.report.evidence import Row

TITLES = {
    "losses": "Each combination of the paper's losses, and a tracker that always says the frame's centre (const)",
    "ingredients": "Our recipe less one ingredient",
}
COLUMNS = {"mean_px": "mean px", "p99_px": "99 % px", "off_track": "off track", "locked": "locked"}


class Part(NamedTuple):
    """One table."""

    title: str
    rows: dict[str, Row | None]
    """Variant to its means over seeds, with `worst` and `per_seed`; None where a seed has not run."""
    bars: dict[str, float]
    """Variant to the length of its mean error's bar, 0 to 1, on a scale that shows small and large ones."""
    choice: Row
    """How well the score that chooses without labels orders the runs: `runs` and `spearman`."""


def load(path: Path) -> dict[str, Any]:
    """What was measured, an empty mapping where nothing was yet; raises InputError where the file is gone."""
    if not path.is_file():
        mend = "restore it with `git checkout`, or write `{}` into it, which says that nothing was measured"
        raise InputError(path, "no such file", mend)
    measured: dict[str, Any] = results.load_json(path)
    return measured


def parts(measured: Mapping[str, Any]) -> list[Part]:
    """The tables of metrics/ablation.json; none where nothing was measured yet."""
    return [
        Part(title, measured[name], _bars(measured[name]), measured.get("choice", {}).get(name, {}))
        for name, title in TITLES.items()
        if any(measured.get(name, {}).values())
    ]


def _bars(rows: Mapping[str, Row | None]) -> dict[str, float]:
    known = {name: row["mean_px"] for name, row in rows.items() if row and row["mean_px"] is not None}
    longest = max(known.values(), default=0) or 1.0
    return {name: round(log1p(value) / log1p(longest), 3) for name, value in known.items()}
