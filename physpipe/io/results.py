"""Small results: strict JSON (no NaN) and CSV."""

import json
import math
from pathlib import Path
from typing import Any

import pandas as pd

from physpipe.core.errors import InputError
from physpipe.io.atomic import replacing


def save_json(path: Path, value: Any) -> None:
    """Writes sorted, indented, strict JSON; a NaN or an infinity becomes null."""
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(_strict(value), indent=1, sort_keys=True, allow_nan=False) + "\n")


def load_json(path: Path) -> Any:
    """Raises InputError when the file is absent."""
    if not path.is_file():
        raise InputError(path, "no such file", "run `dvc repro`, which makes it")
    return json.loads(path.read_text())


def save_csv(path: Path, table: pd.DataFrame) -> None:
    """Writes a CSV with six significant digits."""
    with replacing(path) as temporary:
        table.to_csv(temporary, index=False, float_format="%.6g")


def load_csv(path: Path) -> pd.DataFrame:
    """A table, without columns where nothing was written; raises InputError when the file is absent."""
    if not path.is_file():
        raise InputError(path, "no such file", "run `dvc repro`, which makes it")
    return pd.read_csv(path) if path.read_text().strip() else pd.DataFrame()


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _strict(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float):
        return round(value, 6) if math.isfinite(value) else None
    return value
