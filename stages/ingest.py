"""Recordings to clips: crop, resample by timestamp, resize, trim to motion, cut, split."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.params import read
from physpipe.ingest.dataset import IngestParams, ingest
from physpipe.io import clips


def main(name: str, raw: Path, out: Path) -> None:
    """Writes the clips of every recording in `raw`, and `recordings.csv` with what was found in each."""
    film, recordings = ingest(name, raw, read(f"datasets.{name}.ingest", IngestParams))
    clips.save(out, film, recordings)


if __name__ == "__main__":
    run(main)
