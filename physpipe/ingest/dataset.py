"""A folder of recordings to a set of clips."""

import hashlib
import re
import sys
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pydantic import Field, model_validator

from physpipe.core.errors import DiskFullError, InputError
from physpipe.core.parallel import in_parallel
from physpipe.core.params import Section
from physpipe.core.scratch import scratch_root
from physpipe.ingest import recording
from physpipe.io import packed, video
from physpipe.io.clips import SPLITS, Clip, Split

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


class SplitParams(Section):
    """Shares of the clips, by a hash of each clip's name: adding a recording moves no other clip."""

    valid: float = Field(ge=0, le=1)
    """Share that chooses when to stop learning."""
    test: float = Field(ge=0, le=1)
    """Share that nothing learns from."""

    @model_validator(mode="after")
    def _shares_add_up(self) -> "SplitParams":
        if self.valid + self.test > 1:
            raise ValueError("valid + test exceeds 1")
        return self


class IngestParams(recording.ConvertParams):
    """Section `datasets.<name>.ingest` of params.yaml."""

    split: SplitParams
    """Shares of validation and test; the rest is for training."""
    allow_unreadable: bool
    """Go on without the recordings that give no clip, instead of failing after naming them all."""

    def conversion(self) -> recording.ConvertParams:
        """The part that decides pixels and times: changing the rest decodes nothing again."""
        return recording.ConvertParams(**self.model_dump(include=set(recording.ConvertParams.model_fields)))


def ingest(name: str, raw: Path, params: IngestParams) -> tuple[Iterator[Clip], pd.DataFrame]:
    """The clips of the recordings in `raw`, one at a time, and a table with a row for each recording.

    A recording is decoded only when its bytes, the params or this code changed; its pictures stay in scratch.
    Raises InputError naming every recording that gives no clip (unless allowed), and for an empty split.
    """
    found = video.recordings(raw)
    _refuse_shared_names(found)
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
    _refuse_empty_splits(raw, Counter(split_of(clip, params.split) for clip in _names(entries)), params.split)
    table = pd.DataFrame([_row(path, result) for path, result in results.items()])
    _tell(table)
    return _clips(entries, params.split), table[RECORDINGS]


def _converted(path: Path, store: Path, params: recording.ConvertParams) -> Path | InputError:
    """The entry with the converted recording, or what is wrong with the recording."""
    code = [*Path(__file__).parent.glob("*.py"), Path(video.__file__), Path(packed.__file__)]
    entry = store / packed.fingerprint(path, params, code)
    try:
        if not entry.exists():
            recording.convert(path, entry, params)
    except DiskFullError:
        raise
    except InputError as error:
        return error
    return entry


def _names(entries: dict[Path, Path]) -> list[str]:
    return [
        clip_name(path, part) for path, entry in entries.items() for part in packed.Packed(entry).rows["part"].unique()
    ]


def _clips(entries: dict[Path, Path], split: SplitParams) -> Iterator[Clip]:
    for path, folder in entries.items():
        entry = packed.Packed(folder)
        for part, rows in entry.rows.groupby("part"):
            name = clip_name(path, int(part))
            target_s = rows["target_s"].to_numpy()
            yield Clip(
                name=name,
                split=split_of(name, split),
                source=path.name,
                geometry=entry.geometry,
                frames=entry.pictures[rows["picture"].to_numpy()],
                times_s=target_s - target_s[0],
                source_frames=rows["source_frame"].to_numpy(np.int32),
                source_times_s=rows["source_time_s"].to_numpy(),
                status=rows["status"].to_numpy(str),
            )


def clip_name(path: Path, part: int) -> str:
    """`<stem>_<part>` in characters that every file system takes."""
    stem = path.name if path.is_dir() else path.stem
    return f"{re.sub(r'[^A-Za-z0-9_-]+', '-', stem)}_{part:02d}"


def split_of(clip: str, shares: SplitParams) -> Split:
    """The split of a clip, from its name alone."""
    place = int.from_bytes(hashlib.sha256(clip.encode()).digest()[:8], "big") / 2**64
    if place < shares.valid:
        return "valid"
    return "test" if place < shares.valid + shares.test else "train"


def _refuse_shared_names(found: list[Path]) -> None:
    first: dict[str, Path] = {}
    for path in found:
        twin = first.setdefault(clip_name(path, 0).casefold(), path)
        if twin != path:
            raise InputError(path, f"its clips would be named as those of {twin.name}", "rename one of the two")


def _refuse_empty_splits(raw: Path, clips: Counter[Split], shares: SplitParams) -> None:
    wanted = {"train": 1 - shares.valid - shares.test, "valid": shares.valid, "test": shares.test}
    for split in SPLITS:
        if wanted[split] > 0 and not clips[split]:
            counts = ", ".join(f"{each} {clips[each]}" for each in SPLITS)
            mend = "add recordings, lower `clip_frames`, raise the share, or set it to 0"
            raise InputError(raw, f"no clip falls into the split `{split}` ({counts})", mend)


def _tell(table: pd.DataFrame) -> None:
    """Prints each recording's warnings, and the sums."""
    for row in table[table["warnings"] != ""].itertuples():
        print(f"{row.source}: {row.warnings}", file=sys.stderr)
    sums = [f"{table[key].sum():.0f} {key}" for key in ("clips", "kept", "dropped", "decode_errors", "missing")]
    print(f"{len(table)} recordings: {', '.join(sums)}", file=sys.stderr)


def _row(path: Path, result: Path | InputError) -> dict[str, Any]:
    """The recording's row of recordings.csv."""
    if isinstance(result, InputError):
        return {"source": path.name, "kept": 0, "clips": 0, "warnings": result.reason}
    entry = packed.Packed(result)
    return {
        "source": path.name,
        **entry.summary,
        "kept": len(entry.rows),
        "clips": entry.rows["part"].nunique(),
        "missing": int((entry.rows["status"] == "missing").sum()),
        "warnings": "; ".join(entry.summary["warnings"]),
    }
