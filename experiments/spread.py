"""Figures over seeds: their mean and their worst."""

from collections.abc import Mapping
from statistics import mean
from typing import Any

Row = dict[str, Any]
MORE_IS_BETTER = {"delta_avg", "hota", "idf1", "idf1_unflagged"}


def over_seeds(rows: Mapping[int, Row]) -> Row:
    """Each figure's mean over the seeds' rows, with `worst` and `per_seed` holding the others.

    Worst is the largest, or the smallest where more is better. A truth value is true when it is for every seed. A
    figure that some seed lacks, or has as null, is null.
    """
    keys = sorted({key for row in rows.values() for key in row})
    columns = {key: [row.get(key) for row in rows.values()] for key in keys}
    return {
        **{key: _mean(values) for key, values in columns.items()},
        "worst": {key: _worst(key, values) for key, values in columns.items()},
        "per_seed": {str(seed): row for seed, row in rows.items()},
    }


def _mean(values: list[Any]) -> Any:
    if any(value is None for value in values):
        return None
    return all(values) if isinstance(values[0], bool) else round(mean(values), 6)


def _worst(key: str, values: list[Any]) -> Any:
    if any(value is None for value in values):
        return None
    if isinstance(values[0], bool):
        return all(values)
    return min(values) if key in MORE_IS_BETTER else max(values)
