"""Learn the first detector of a data set, without labels."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io.checkpoints import forget, scratch
from physpipe.io.clips import ClipSet
from physpipe.tracker_learning.first import learn_first
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracker_learning.saving import save_first


def main(clips: Path, out: Path) -> None:
    """Writes T1 with its curve, heat maps and verdict to the folder `out`."""
    params, compute = read("tracker", TrackerParams), read("compute", ComputeParams)
    prepare(compute)
    folder = scratch("train_tracker", [params, compute], [clips])
    learned = learn_first(ClipSet(clips), params, compute, folder)
    save_first(out, ClipSet(clips), learned, params)
    forget(folder)


if __name__ == "__main__":
    run(main)
