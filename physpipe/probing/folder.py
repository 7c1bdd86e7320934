"""A folder of film: every recording looked at, and what to ingest the set with."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from physpipe.core.errors import InputError
from physpipe.core.parallel import in_parallel
from physpipe.ingest.splits import SplitParams
from physpipe.io import folders, split_file
from physpipe.probing.advice import Advice, advise
from physpipe.probing.findings import Finding, look


@dataclass(frozen=True)
class Probed:
    """What a folder holds."""

    found: list[Finding]
    unreadable: list[InputError]
    advice: Advice


def probe(folder: Path, size: int, shares: SplitParams, source_fps: float | None) -> Probed:
    """Looks at every recording of `folder`; `size` and `shares` are those of the set's section, as in `advise`.

    Raises InputError where there is none that can be read, naming each.
    """
    recordings = folders.recordings(folder)
    divided = split_file.read(folder, recordings) is not None
    looks = list(in_parallel(partial(_look, folder=folder, source_fps=source_fps), recordings, "probe"))
    found = [each for each in looks if isinstance(each, Finding)]
    unreadable = [each for each in looks if isinstance(each, InputError)]
    if not found:
        listed = "".join(f"\n  {each}" for each in unreadable)
        raise InputError(folder, f"no recording can be read:{listed}\n", "convert them, or copy them again")
    return Probed(found, unreadable, advise(found, size, None if divided else shares, source_fps))


def _look(path: Path, folder: Path, source_fps: float | None) -> Finding | InputError:
    try:
        return look(path, folder, source_fps)
    except InputError as error:
        return error
