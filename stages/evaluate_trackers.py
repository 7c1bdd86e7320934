"""Errors of every tracker against the truth, test split only."""

from pathlib import Path

from physpipe.core.ball import BallParams
from physpipe.core.command import run
from physpipe.core.params import read, read_value
from physpipe.io import results, tracks
from physpipe.io.clips import ClipSet
from physpipe.scoring.trackers import EvaluateTrackersParams, score_trackers


def main(
    name: str, clips: Path, truth: Path, found: Path, unrefined: Path, verdict: Path, baselines: Path, out: Path
) -> None:
    """Writes figures per tracker to `out`, and every frame's error to `tracker_errors.csv` beside it."""
    params = read("evaluate_trackers", EvaluateTrackersParams)
    ball = read(f"datasets.{name}.evaluate", BallParams)
    ours = {"unsupervised": tracks.load(found), "unsupervised_unrefined": tracks.load(unrefined)}
    tables = ours
    for each in ["untrained", *read_value("run.flow")]:  # what other runs left beside them is not looked at
        tables = tables | tracks.load_folder(baselines / each)
    verdicts = dict.fromkeys(ours, results.load_json(verdict))
    figures, errors = score_trackers(ClipSet(clips), tracks.load(truth), tables, verdicts, params, ball)
    results.save_json(out, figures)
    results.save_csv(out.parent / "tracker_errors.csv", errors)


if __name__ == "__main__":
    run(main)
