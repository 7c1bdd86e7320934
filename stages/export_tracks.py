"""Track every clip with the trained detectors."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.trackers import detectors
from physpipe.trackers.learned import ReadoutParams
from physpipe.trackers.sequential import MaskParams


def main(clips: Path, trained: Path, out: Path) -> None:
    """Reads T1 ... TK from the folder `trained`; writes THE track table to `out`."""
    readout, mask = read("tracker.readout", ReadoutParams), read("tracker.mask", MaskParams)
    prepare(read("compute", ComputeParams))
    tracker = detectors.together(detectors.load(trained / detectors.WEIGHTS), readout, mask)
    tracks.save(out, detectors.track_table(ClipSet(clips), tracker), "physpipe unsupervised", ClipSet(clips))


if __name__ == "__main__":
    run(main)
