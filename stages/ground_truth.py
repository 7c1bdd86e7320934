"""Where the objects really are, from what the user annotated."""

from pathlib import Path

from physpipe.baselines.ground_truth import ground_truth
from physpipe.baselines.template import TemplateParams
from physpipe.core.command import run
from physpipe.core.params import read
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet


def main(name: str, clips: Path, annotated: Path, out: Path) -> None:
    """Writes the truth of the data set's annotated clips."""
    params = read("ground_truth", TemplateParams)
    film = ClipSet(clips)
    truth = ground_truth(film, annotations.load(annotated, film), params)
    tracks.save(out, truth, f"ground_truth {name}", film)


if __name__ == "__main__":
    run(main)
