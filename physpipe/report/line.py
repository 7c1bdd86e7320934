"""One curve of a chart, as the page's script draws it."""

from typing import Any

import pandas as pd

from physpipe.report import colours

DIGITS = 4
Chart = dict[str, Any]


def line(
    name: str, model: str, colour: str, points: pd.DataFrame, dashed: bool = False, wide: bool = False
) -> dict[str, Any]:
    """A line through `points`, two columns, x first; `model` as in the page's filters, empty for what has none."""
    x, y = (points[column].astype(float) for column in points)
    return {
        "name": name.replace("_", " "),
        "model": model,
        "colour": colours.for_page(colour),
        "dashed": dashed,
        "wide": wide,
        "x": [_short(value) for value in x],
        "y": [_short(value) for value in y],
    }


def _short(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if pd.notna(value) else None
