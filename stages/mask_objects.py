"""Learn a detector for every further object, the earlier ones masked out."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.objects import ObjectsParams
from physpipe.core.params import read
from physpipe.io.checkpoints import forget, scratch
from physpipe.io.clips import ClipSet
from physpipe.tracker_learning.others import learn_others
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracker_learning.saving import save_all
from physpipe.trackers import detectors


def main(name: str, clips: Path, first: Path, out: Path) -> None:
    """Reads T1 from the folder `first`; writes T1 ... TK with curves, heat maps and verdict to `out`."""
    params, compute = read("tracker", TrackerParams), read("compute", ComputeParams)
    objects = read(f"datasets.{name}.motion", ObjectsParams)
    prepare(compute)
    folder = scratch("mask_objects", [params, compute, objects], [clips, first])
    net = detectors.load(first / detectors.WEIGHTS)[0]
    others = learn_others(ClipSet(clips), net, objects, params, compute, folder)
    save_all(out, ClipSet(clips), first, others, params)
    forget(folder)


if __name__ == "__main__":
    run(main)
