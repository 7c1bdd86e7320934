"""Gather every data set's results into the metrics files and one page."""

from pathlib import Path

from physpipe.core import params
from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams
from physpipe.report import ablation
from physpipe.report.evidence import Sources, gather
from physpipe.report.page import write_page
from physpipe.report.params import ReportParams
from physpipe.report.run import RunParams
from physpipe.report.tables import save_metrics
from physpipe.tracknet.signals import LockParams


def main(
    clips: Path,
    truth: Path,
    tracks: Path,
    scores: Path,
    forecasts: Path,
    trackers: Path,
    predictors: Path,
    ablated: Path,
    metrics: Path,
    page: Path,
) -> None:
    """Writes `metrics/*.json`, `metrics/*.csv` and the folder `page`; every other path is read."""
    ran = params.read("run", RunParams)
    shown = params.read("report", ReportParams)
    compute = params.read("compute", ComputeParams)
    bounds = params.read("tracker.lock", LockParams)
    sources = Sources(clips, truth, tracks, scores, forecasts, trackers, predictors)
    measured = ablation.load(ablated)
    every = [gather(name, ran, sources, shown.predictor) for name in ran.datasets]
    save_metrics(metrics, every, shown.predictor)
    write_page(page, every, measured, compute.seed, shown, bounds)


if __name__ == "__main__":
    run(main)
