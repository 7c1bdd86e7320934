"""Simulated recordings: videos as a camera would leave them, and where the objects really were."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from physpipe.io.annotations import REFERENCE
from physpipe.io.atomic import replacing_folder


@dataclass(frozen=True)
class Recording:
    """One encoded video and the exact object centres in it."""

    source: str
    """File name."""
    video: bytes
    """The file's content."""
    xy: NDArray[np.float64]
    """(F, K, 2) centres in pixels of the source, a row a frame in decode order."""


def save(raw: Path, annotations: Path, recordings: Iterable[Recording]) -> None:
    """Writes the videos into `raw` and their truth into `annotations`/reference.csv; both appear only when complete."""
    tables = []
    with replacing_folder(annotations) as truth, replacing_folder(raw) as videos:
        for recording in recordings:
            (videos / recording.source).write_bytes(recording.video)
            tables.append(_rows(recording))
        pd.concat(tables).to_csv(truth / REFERENCE, index=False, float_format="%.4f")


def _rows(recording: Recording) -> pd.DataFrame:
    F, K = recording.xy.shape[:2]
    columns = {
        "source": recording.source,
        "object": np.repeat(np.arange(K), F),
        "frame": np.tile(np.arange(F), K),
        "x": recording.xy[..., 0].T.ravel(),
        "y": recording.xy[..., 1].T.ravel(),
    }
    return pd.DataFrame(columns)
