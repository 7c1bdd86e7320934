"""Arrays as lists for JSON, which knows no NaN."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray


def listed(values: NDArray[np.floating], decimals: int) -> list[Any]:
    """Nested lists; null for a number that is not known, and for a point or an ellipse that has such a one."""
    if values.ndim == 1:
        return list(_numbers(values, decimals))
    if values.ndim == 2:
        return [list(_numbers(row, decimals)) for row in values]
    known = np.isfinite(values).all(axis=-1)
    return [
        [list(_numbers(each, decimals)) if there else None for each, there in zip(row, found, strict=True)]
        for row, found in zip(values, known, strict=True)
    ]


def _numbers(values: NDArray[np.floating], decimals: int) -> Iterator[float | None]:
    for value in values.tolist():
        yield round(value, decimals) if np.isfinite(value) else None
