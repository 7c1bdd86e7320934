"""A folder of recordings to a set of clips."""

import re
import sys
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from physpipe.core.errors import DiskFullError, InputError
from physpipe.core.parallel import in_parallel
from physpipe.core.scratch import scratch_root
from physpipe.ingest import recording
from physpipe.ingest.splits import SplitParams, Splits
from physpipe.io import folders, packed, split_file, video
from physpipe.io.clips import Clip

RECORDINGS = [
    "source",
    "claimed_fps",
    "measured_fps",
    "frames",
    "kept",
    "dropped",
    "clips",
    "decode_errors",
    "missing",
    "warnings",
]


class IngestParams(recording.ConvertParams):
    """Section `datasets.<name>.ingest` of params.yaml."""

    split: SplitParams
    """Shares of validation and test, the rest being for training, where the set brings no split file."""
    allow_unreadable: bool
    """Go on without the recordings that give no clip, instead of failing after naming them all."""

    def conversion(self) -> recording.ConvertParams:
        """The part that decides pixels and times: changing the rest decodes nothing again."""
        return recording.ConvertParams(**self.model_dump(include=set(recording.ConvertParams.model_fields)))


def ingest(name: str, raw: Path, params: IngestParams) -> tuple[Iterator[Clip], pd.DataFrame]:
    """The clips of the recordings in `raw`, one at a time, and a table with a row for each recording.

    A recording is decoded only when its bytes, the params or this code changed; its pictures stay in scratch.
    Raises InputError naming every recording that gives no clip (unless allowed), or every bad line of the split file,
    and for an empty split.
    """
    found = folders.recordings(raw)
    _refuse_shared_names(raw, found)
    splits = Splits(params.split, split_file.read(raw, found))
    store = scratch_root() / "ingest" / name
    work = partial(_converted, store=store, params=params.conversion())
    results = dict(zip(found, in_parallel(work, found, f"ingest {name}"), strict=True))
    bad = {path: result for path, result in results.items() if isinstance(result, InputError)}
    entries = {path: result for path, result in results.items() if isinstance(result, Path)}
    if bad and not (params.allow_unreadable and entries):
        listed = "".join(f"\n  {error}" for error in bad.values())
        mend = "remove or mend them, or set `allow_unreadable: true` to go on without them"
        raise InputError(raw, f"{len(bad)} of {len(found)} recordings give no clip:{listed}\n", mend)
    packed.prune(store, entries.values())
    splits.refuse_empty(raw, Counter(splits.of(source, clip) for source, clip in _names(raw, entries)))
    table = pd.DataFrame([_row(folders.source(path, raw), result) for path, result in results.items()])
    _tell(table)
    return _clips(raw, entries, splits), table[RECORDINGS]


def _converted(path: Path, store: Path, params: recording.ConvertParams) -> Path | InputError:
    """The entry with the converted recording, or what is wrong with the recording."""
    code = [*Path(__file__).parent.glob("*.py"), *map(Path, (folders.__file__, packed.__file__, video.__file__))]
    entry = store / packed.fingerprint(path, params, code)
    try:
        if not entry.exists():
            recording.convert(path, entry, params)
    except DiskFullError:
        raise
    except InputError as error:
        return error
    return entry


def _names(raw: Path, entries: dict[Path, Path]) -> Iterator[tuple[str, str]]:
    """Source and name of every clip."""
    for path, folder in entries.items():
        for part in packed.Packed(folder).rows["part"].unique():
            yield folders.source(path, raw), clip_name(folders.stem(path, raw), part)


def _clips(raw: Path, entries: dict[Path, Path], splits: Splits) -> Iterator[Clip]:
    for path, folder in entries.items():
        entry, source = packed.Packed(folder), folders.source(path, raw)
        for part, rows in entry.rows.groupby("part"):
            name = clip_name(folders.stem(path, raw), int(part))
            target_s = rows["target_s"].to_numpy()
            yield Clip(
                name=name,
                split=splits.of(source, name),
                source=source,
                geometry=entry.geometry,
                frames=entry.pictures[rows["picture"].to_numpy()],
                times_s=target_s - target_s[0],
                source_frames=rows["source_frame"].to_numpy(np.int32),
                source_times_s=rows["source_time_s"].to_numpy(),
                status=rows["status"].to_numpy(str),
            )


def clip_name(stem: str, part: int) -> str:
    """`<stem>_<part>`, folders and all, in characters that every file system takes."""
    return f"{re.sub(r'[^A-Za-z0-9_-]+', '-', stem)}_{part:02d}"


def _refuse_shared_names(raw: Path, found: list[Path]) -> None:
    first: dict[str, Path] = {}
    for path in found:
        twin = first.setdefault(clip_name(folders.stem(path, raw), 0).casefold(), path)
        if twin != path:
            raise InputError(
                path, f"its clips would be named as those of {folders.source(twin, raw)}", "rename one of the two"
            )


def _tell(table: pd.DataFrame) -> None:
    """Prints each recording's warnings, and the sums."""
    for row in table[table["warnings"] != ""].itertuples():
        print(f"{row.source}: {row.warnings}", file=sys.stderr)
    sums = [f"{table[key].sum():.0f} {key}" for key in ("clips", "kept", "dropped", "decode_errors", "missing")]
    print(f"{len(table)} recordings: {', '.join(sums)}", file=sys.stderr)


def _row(source: str, result: Path | InputError) -> dict[str, Any]:
    """The recording's row of recordings.csv."""
    if isinstance(result, InputError):
        return {"source": source, "kept": 0, "clips": 0, "warnings": result.reason}
    entry = packed.Packed(result)
    return {
        "source": source,
        **entry.summary,
        "kept": len(entry.rows),
        "clips": entry.rows["part"].nunique(),
        "missing": int((entry.rows["status"] == "missing").sum()),
        "warnings": "; ".join(entry.summary["warnings"]),
    }
