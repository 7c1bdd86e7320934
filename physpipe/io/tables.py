"""Parquet tables that say what they are: rows checked, metadata of ours beside them."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from physpipe.core.errors import InputError
from physpipe.io.atomic import replacing

OURS = b"physpipe"


def write(path: Path, table: pd.DataFrame, about: Mapping[str, Any], categories: Iterable[str] = ()) -> None:
    """Writes `table` whole or not at all, `about` into its metadata, the columns `categories` dictionary-encoded."""
    arrow = pa.Table.from_pandas(table, preserve_index=False)
    for name in categories:
        arrow = arrow.set_column(arrow.schema.get_field_index(name), name, arrow[name].dictionary_encode())
    kept = {**(arrow.schema.metadata or {}), OURS: json.dumps(about, sort_keys=True).encode()}
    with replacing(path) as temporary:
        pq.write_table(arrow.replace_schema_metadata(kept), temporary)


def read(path: Path, columns: Iterable[str], what: str) -> pd.DataFrame:
    """The table at `path`; raises InputError when there is none, or it lacks a column that a `what` has."""
    if not path.is_file():
        raise InputError(path, "no such file", "run `dvc repro`, which makes it")
    table = pq.read_table(path).to_pandas()
    missing = set(columns) - set(table.columns)
    if missing:
        raise InputError(path, f"not a {what}: lacks {sorted(missing)}", "make it again with `dvc repro`")
    return table


def metadata(path: Path) -> Mapping[str, Any]:
    """What `write` was told about the table."""
    return json.loads(pq.read_schema(path).metadata[OURS])


def refuse_rows(path: Path, table: pd.DataFrame, faults: Mapping[str, pd.Series]) -> None:
    """Raises InputError naming the first row of clip, object and frame that has one of `faults`, and how many do."""
    for fault, bad in faults.items():
        if bad.any():
            row = table[bad].iloc[0]
            where = f"clip {row['clip']}, object {row['object']}, frame {row['frame']}"
            raise InputError(path, f"row of {where} {fault} ({int(bad.sum())} such rows)", "correct the rows")
