"""Tracks of every baseline tracker, test split only."""

from pathlib import Path

from physpipe.baselines.running import baseline_tracks
from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BaselineParams, Settings, known_flows
from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.params import read
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet


def main(name: str, clips: Path, annotated: Path, truth: Path, out: Path) -> None:
    """Writes a folder with a track table for each baseline."""
    params, template = read("baselines", BaselineParams), read("ground_truth", TemplateParams)
    radius_px = read(f"datasets.{name}.evaluate", BallParams).ball_radius_px
    film = ClipSet(clips)
    given = annotations.load(annotated, film)
    settings = Settings(params, template, radius_px, known_flows(params))
    tables = baseline_tracks(film, given, tracks.load(truth), settings)
    tracks.save_folder(out, tables, "baseline_tracks", film)


if __name__ == "__main__":
    run(main)
