"""Where the pipeline keeps what the commands read (docs/conventions.md), and where they write."""

from pathlib import Path

from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS, nearest, read_value

DATA, EXPORTS = Path("data"), Path("exports")
RAW, ANNOTATIONS, CLIPS, TRACKS, TRUTH, FORECASTS = (
    DATA / each for each in ("raw", "annotations", "clips", "tracks", "truth", "forecasts")
)


def known_set(name: str) -> str:
    """`name`, if params.yaml has such a data set; raises InputError otherwise, with the likeliest name."""
    sets = list(read_value("datasets"))
    if name not in sets:
        raise InputError(PARAMS, f"no data set `{name}`{nearest(name, sets)}", f"use one of {', '.join(sets)}")
    return name
