"""Converted recordings, kept between runs by content, so that adding a video decodes one video."""

import hashlib
import json
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import BaseModel

from physpipe.core.geometry import Geometry
from physpipe.io.atomic import replacing_folder
from physpipe.io.folders import images

PICTURES, ROWS, SUMMARY = "pictures.rgb", "rows.parquet", "summary.json"


class Packed:
    """A converted recording: pictures (each kept frame once), rows that point at them, geometry, summary."""

    def __init__(self, folder: Path):
        saved = json.loads((folder / SUMMARY).read_text())
        self.geometry = Geometry(**saved["geometry"])
        self.summary: dict[str, Any] = saved["summary"]
        self.rows = pd.read_parquet(folder / ROWS)
        self.pictures = _mapped(folder, self.geometry.height, self.geometry.width)


class Writer:
    """What a conversion fills, picture by picture, so that memory does not grow with the recording."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._file = (folder / PICTURES).open("wb")

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Appends one (H, W, 3) picture."""
        self._file.write(np.ascontiguousarray(picture).data)

    def pictures(self, height: int, width: int) -> NDArray[np.uint8]:
        """(N, H, W, 3) added so far, mapped from disk."""
        self._file.flush()
        return _mapped(self._folder, height, width)

    def finish(self, rows: pd.DataFrame, geometry: Geometry, summary: dict[str, Any]) -> None:
        """Adds what goes beside the pictures."""
        rows.to_parquet(self._folder / ROWS, index=False)
        (self._folder / SUMMARY).write_text(json.dumps({"geometry": asdict(geometry), "summary": summary}))

    def close(self) -> None:
        """Ends the file of pictures."""
        self._file.close()


@contextmanager
def writing(folder: Path) -> Iterator[Writer]:
    """A new entry at `folder`, which appears only when the block ends well."""
    with replacing_folder(folder) as temporary:
        writer = Writer(temporary)
        try:
            yield writer
        finally:
            writer.close()


def fingerprint(recording: Path, params: BaseModel, code: Iterable[Path]) -> str:
    """Hash of all that decides a conversion: the recording's bytes (not its name), the params, the code."""
    digest = hashlib.sha256(params.model_dump_json().encode())
    for path in sorted(code):
        digest.update(path.read_bytes())
    for path in images(recording) if recording.is_dir() else [recording]:
        with path.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    return digest.hexdigest()[:32]


def prune(folder: Path, keep: Iterable[Path]) -> None:
    """Removes the entries of `folder` that are not in `keep`."""
    for each in set(folder.iterdir()) - set(keep):
        shutil.rmtree(each)


def _mapped(folder: Path, height: int, width: int) -> NDArray[np.uint8]:
    return np.memmap(folder / PICTURES, np.uint8, mode="r").reshape(-1, height, width, 3)
