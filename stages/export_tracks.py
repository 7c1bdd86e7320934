"""Track every clip with the trained detectors."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.objects import ObjectsParams
from physpipe.core.params import read
from physpipe.io import results, tracks
from physpipe.io.clips import ClipSet
from physpipe.trackers import detectors
from physpipe.trackers.tables import track_tables


def main(name: str, clips: Path, trained: Path, out: Path, unrefined: Path) -> None:
    """Reads T1 ... TK from the folder `trained`; writes THE track table to `out`, and as it was before refinement."""
    tracking = read("tracker.tracking", detectors.TrackingParams)
    objects = read(f"datasets.{name}.motion", ObjectsParams)
    prepare(read("compute", ComputeParams))
    # A predictor that was tuned with it goes on from as many tracks as it has learned
    tuned_to = results.load_json(trained / "verdict.json").get("tracks")
    objects = objects if tuned_to is None else ObjectsParams(objects=tuned_to)
    film, nets = ClipSet(clips), detectors.load(trained / detectors.WEIGHTS)
    after, before = track_tables(film, detectors.together(nets, tracking), objects, tracking.refine)
    tracks.save(out, after, "physpipe unsupervised", film)
    tracks.save(unrefined, before, "physpipe unsupervised, before refinement", film)


if __name__ == "__main__":
    run(main)
