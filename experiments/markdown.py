"""Tables in Markdown."""

from collections.abc import Collection
from typing import Any

from experiments.spread import Row

Columns = dict[str, str]
"""Key of a figure to the head of its column."""


def columns_with_figures(columns: Columns, rows: Collection[Row]) -> Columns:
    """Those that some row has a figure for."""
    return {key: head for key, head in columns.items() if any(row.get(key) is not None for row in rows)}


def line(cells: list[str]) -> str:
    """A row of a Markdown table."""
    return f"| {' | '.join(cells)} |\n"


def number(value: Any) -> str:
    """A figure in two decimals or none, a dash for what is not known."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.0f}" if isinstance(value, int) or abs(value) >= 100 else f"{value:.2f}"
