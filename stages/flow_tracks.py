"""Tracks of the dense-flow trackers on a learned flow, test split only."""

from pathlib import Path

from physpipe.baselines.learned_flow import FLOW_TRACKERS, LearnedFlow, LearnedFlowParams
from physpipe.baselines.running import baseline_tracks
from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BaselineParams, Settings
from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet


def main(name: str, clips: Path, annotated: Path, truth: Path, network: Path, out: Path) -> None:
    """Writes a folder with a track table for each dense-flow tracker, on the flow of the trained `network`."""
    params = read("baselines", BaselineParams).model_copy(update={"names": list(FLOW_TRACKERS)})
    template = read("ground_truth", TemplateParams)
    radius_px = read(f"datasets.{name}.evaluate", BallParams).ball_radius_px
    prepare(read("compute", ComputeParams))
    flow = LearnedFlow(network, read("flow_tracks", LearnedFlowParams))
    film = ClipSet(clips)
    given, settings = annotations.load(annotated, film), Settings(params, template, radius_px, {"flow": flow})
    tracks.save_folder(out, baseline_tracks(film, given, tracks.load(truth), settings), "flow_tracks", film)


if __name__ == "__main__":
    run(main)
