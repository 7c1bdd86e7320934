"""Tracks of the dense-flow trackers on a learned flow, test split only."""

from pathlib import Path

from physpipe.baselines.learned_flow import FLOW_TRACKERS, LearnedFlow, LearnedFlowParams
from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BaselineParams, baseline_tracks
from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet


def main(name: str, clips: Path, annotated: Path, truth: Path, network: Path, out: Path) -> None:
    """Writes a folder with a track table for each dense-flow tracker, on the flow of the trained `network`."""
    params = read("baselines", BaselineParams).model_copy(update={"names": list(FLOW_TRACKERS)})
    template, ball = read("ground_truth", TemplateParams), read(f"datasets.{name}.evaluate", BallParams)
    prepare(read("compute", ComputeParams))
    flow = LearnedFlow(network, read("flow_tracks", LearnedFlowParams))  # noqa: F841 until the next but two takes it
    film = ClipSet(clips)
    given = annotations.load(annotated, film)
    tables = baseline_tracks(film, given, tracks.load(truth), params, template, ball.ball_radius_px)
    tracks.save_folder(out, tables, "flow_tracks", film)


if __name__ == "__main__":
    run(main)
