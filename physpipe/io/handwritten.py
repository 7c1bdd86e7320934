"""CSV files that people write: every cell as text, every row with the number of its line."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from physpipe.core.errors import InputError


def rows(path: Path, columns: Sequence[str]) -> pd.DataFrame:
    """The rows that are not blank, as text without surrounding blanks; the index is the line's number in the file.

    Raises InputError when the file is no table, or lacks one of `columns`; it may have more of them.
    """
    mend = f"begin it with {','.join(columns)}"
    try:
        words = pd.read_csv(path, dtype=str, keep_default_na=False, skip_blank_lines=False, index_col=False)
    except ValueError as error:
        raise InputError(path, f"not a table ({error})", mend) from None
    words = words.rename(columns=str.strip)
    missing = [name for name in columns if name not in words]
    if missing:
        raise InputError(path, f"lacks column(s) {', '.join(missing)}", mend)
    words = words.apply(lambda column: column.str.strip())
    words.index += 2
    return words[(words != "").any(axis=1)]
