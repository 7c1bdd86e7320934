"""A made-up project: `bowls` with truth and a locked tracker, `film` with neither, and files of other runs."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

from physpipe.core.geometry import Geometry
from physpipe.core.horizon import BASELINES
from physpipe.io import clips, forecasts, results, tracks
from physpipe.report.evidence import Evidence, Sources, gather
from physpipe.report.page import write_page
from physpipe.report.params import ReportParams
from physpipe.report.plate import PlateParams
from physpipe.report.playing import FilmParams
from physpipe.report.run import RunParams
from physpipe.tracknet.signals import LockParams

LOCK = LockParams(order_accuracy=0.8, siamese_px=3.0, entropy_nats=3.0, motion_share=0.3, extent_px=0.5)
ABLATION = {
    "dataset": "bowlr_sim",
    "losses": {
        "disc": None,
        "disc+ent": {
            "mean_px": 1.5,
            "p99_px": 4.0,
            "off_track": 0.0,
            "locked": True,
            "worst": {"mean_px": 2.5, "p99_px": 4.0},
            "seeds": [0, 1],
        },
        "const": {"mean_px": 24.0, "p99_px": 40.0, "off_track": 1.0, "locked": None, "worst": {}, "seeds": [0]},
    },
    "ingredients": {"full recipe": None},
    "choice": {"losses": {"runs": 2, "spearman": None}, "ingredients": {"runs": 0, "spearman": None}},
}
"""As `make ablation` writes it."""


@dataclass(frozen=True)
class World:
    """What the made-up data sets are like."""

    rate: float = 60.0
    """Frames a second."""
    off_px: float = 1.5
    """Distance of the track from the truth, along x."""
    seen: int = 4
    """Frames that the predictors see."""
    horizon: int = 5
    """T of the predictors, which forecast to 4 T."""
    height: int = 40
    width: int = 56
    frames: int = 24
    trackers: tuple[str, ...] = ("unsupervised", "lucas_kanade", "centre")
    learned: tuple[str, ...] = ("dispnet", "probnet")


@dataclass(frozen=True)
class Project:
    """The made-up project's folders and params."""

    world: World
    root: Path
    sources: Sources
    run: RunParams
    shown: ReportParams
    lock: LockParams
    ablation: dict

    def evidence(self, name: str) -> Evidence:
        return gather(name, self.run, self.sources, self.shown.predictor)

    def every(self) -> list[Evidence]:
        return [self.evidence(name) for name in self.run.datasets]


def motion(world: World, clip: int, K: int) -> np.ndarray:
    """(T, K, 2) pixels: every object circles the frame's centre, each clip from another angle."""
    angle = np.arange(world.frames)[:, None] * 0.15 + np.arange(K) * np.pi + clip
    reach = np.array([world.width, world.height]) * 0.3
    centre = np.array([world.width, world.height]) / 2
    return centre + reach * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _clip(world: World, name: str, split: clips.Split, xy: np.ndarray) -> clips.Clip:
    rng = np.random.default_rng(1)
    frames = np.tile(rng.integers(70, 110, (world.height, world.width, 3), dtype=np.uint8), (world.frames, 1, 1, 1))
    for frame, spots in zip(frames, xy, strict=True):
        for x, y in spots:
            cv2.circle(frame, (round(x), round(y)), 3, (200, 40, 40), -1, cv2.LINE_AA)
    T = world.frames
    times = np.arange(T) / world.rate
    geometry = Geometry(0, 0, world.width, world.height, world.width, world.height)
    status = np.full(T, "ok")
    return clips.Clip(name, split, "made_up.mp4", geometry, frames, times, np.arange(T, dtype=np.int32), times, status)


def _data_set(sources: Sources, world: World, name: str, K: int, annotated: bool, locked: bool) -> None:
    splits: tuple[clips.Split, ...] = ("train", "train", "valid", "test", "test")
    names = [f"{name}_{index:03d}" for index in range(len(splits))]
    paths = {clip: motion(world, index, K) for index, clip in enumerate(names)}
    clips.save(
        sources.clips / name,
        (_clip(world, each, split, paths[each]) for each, split in zip(names, splits, strict=True)),
    )
    clip_set = clips.ClipSet(sources.clips / name)
    tables: dict[str, list[pd.DataFrame]] = {"truth": [tracks.empty()], "track": []}
    for clip, xy in paths.items():
        score = np.full(xy.shape[:2], 0.9)
        score[10:14] = 0.2 if clip == names[0] else 0.8
        times = clip_set.times_s(clip)
        if annotated:
            tables["truth"].append(tracks.rows(clip, times, xy, np.ones(xy.shape[:2]), "reference"))
        tables["track"].append(tracks.rows(clip, times, xy + np.array([world.off_px, 0]), score))
    tracks.save(sources.truth / f"{name}.parquet", pd.concat(tables["truth"]), "made up", clip_set)
    tracks.save(sources.tracks / f"{name}.parquet", pd.concat(tables["track"]), "made up", clip_set)
    _learning(sources, name, world, K, locked)
    _scores(sources.scores / name, name, world, annotated, locked)
    for number, predictor in enumerate(world.learned):
        path = sources.forecasts / name / "tracks" / f"{predictor}.parquet"
        _forecast(path, world, {clip: paths[clip] for clip in names[3:]}, number + 1.0)
    for number, predictor in enumerate(BASELINES):
        path = sources.forecasts / name / "tracks" / f"{predictor}.parquet"
        _forecast(path, world, {clip: paths[clip] for clip in names[3:]}, number + 4.0, sure=True)


def _forecast(path: Path, world: World, paths: dict[str, np.ndarray], drift_px: float, sure: bool = False) -> None:
    """A forecast that leaves the truth along y by 0.3 `drift_px` a frame, unless `sure` with a growing spread."""
    parts = []
    for clip, xy in paths.items():
        T, K = xy.shape[:2]
        frame, number = np.meshgrid(np.arange(world.seen, T), np.arange(K), indexing="ij")
        ahead = (frame - world.seen + 1).ravel()
        spread = (0.4 * ahead) ** 2 + 1.0
        spots = xy[world.seen :].reshape(-1, 2)
        columns = {
            "clip": clip,
            "object": number.ravel(),
            "frame": frame.ravel(),
            "x": spots[:, 0],
            "y": spots[:, 1] + drift_px * ahead * 0.3,
        }
        unsure = {} if sure else {"cov_xx": spread, "cov_xy": 0.3 * spread, "cov_yy": spread}
        parts.append(pd.DataFrame({**columns, **unsure}))
    forecasts.save(path, pd.concat(parts), "made up", world.seen, world.horizon)


def heat_sheet(columns: tuple[int, ...]) -> np.ndarray:
    """(40, 30 n, 3): a grey level a column, told by its number."""
    return np.concatenate([np.full((40, 30, 3), 60 * column, np.uint8) for column in columns], axis=1)


def _learning(sources: Sources, name: str, world: World, K: int, locked: bool) -> None:
    step = np.arange(0, 3000, 5)
    fall = np.exp(-step / 800)
    curve = pd.DataFrame({"step": step, "phase": "start 0", "disc": 0.1 + 0.6 * fall, "entropy_nats": 1 + 5 * fall})
    both = pd.concat([curve, curve.assign(phase="rest", disc=0.3 * fall)])
    results.save_csv(sources.trackers / name / "first" / "curve.csv", both)
    results.save_csv(sources.trackers / name / "all" / "curve.csv", curve.assign(phase="object 1") if K > 1 else both)
    for part, columns in (("first", (0, 1, 2)), ("all", (0, 2))):  # the film, a start, the end
        cv2.imwrite(str(sources.trackers / name / part / "heatmaps.png"), heat_sheet(columns))
    signals = [{"object": 0, "entropy_nats": 1.2345 if locked else 4.5, "locked": locked}]
    verdict = {"locked": locked, "objects": signals}
    results.save_json(sources.trackers / name / "all" / "verdict.json", verdict)
    fitted = pd.DataFrame({"step": step, "train": 30 * fall + 1, "valid": 32 * fall + 2})
    for supervision in ("tracks", "truth"):
        for predictor in (*world.learned, "vin"):
            results.save_csv(sources.predictors / name / supervision / predictor / "curve.csv", fitted)


def _scores(folder: Path, name: str, world: World, annotated: bool, locked: bool) -> None:
    """Scores in which every number tells where it came from; `vin` is left from another run."""
    rng = np.random.default_rng(3)
    empty = pd.DataFrame(columns=["tracker", "clip", "object", "frame", "error_px"])
    trackers, errors = {}, [empty]
    for number, tracker in enumerate(world.trackers):
        error = np.abs(rng.normal(world.off_px + number, 0.4, 300))
        error[: 20 * number] = np.nan
        rows = {"tracker": tracker, "clip": f"{name}_003", "object": 0, "frame": np.arange(300), "error_px": error}
        mean = float(np.nanmean(error))
        figures = {"mean_px": mean, "mean_px_low": mean - 0.1, "mean_px_high": mean + 0.1, "lost": 0.1 * number}
        figures |= {"var_px2": float(np.nanvar(error)), "p99_px": float(np.nanquantile(error, 0.99)), "off_track": 0.0}
        verdict = {"locked": locked if tracker == "unsupervised" else None, "clips": 2 if annotated else 0}
        trackers[tracker] = {**(figures if annotated else dict.fromkeys(figures)), **verdict}
        errors += [pd.DataFrame(rows)] if annotated else []
    results.save_json(folder / "trackers.json", trackers)
    results.save_csv(folder / "tracker_errors.csv", pd.concat(errors))
    predictors: dict[str, dict] = {
        "calibration": {"linear_T_px": 19.0, "linear_2T_px": 65.0, "quadratic_T_px": 12.0, "quadratic_2T_px": 90.0}
        if annotated
        else {}
    }
    curves = [pd.DataFrame(columns=["supervision", "predictor", "frame", "error_px"])]
    frame = np.arange(1, world.frames)
    for supervision in ("tracks", "truth"):
        predictors[supervision] = {}
        for number, predictor in enumerate(dict.fromkeys([*BASELINES, *world.learned, "vin"])):
            size = 40.0 if predictor == "persistence" else 2.0 + number + len(supervision) / 100
            row = {"error_T_px": size, "error_T_px_low": size * 0.9, "error_T_px_high": size * 1.1}
            row |= {"error_2T_px": 2 * size, "error_4T_px": 4 * size, "skill_T": 1 - size / 40}
            row |= {"coverage_90": 0.88 if predictor == "probnet" else None}
            predictors[supervision][predictor] = row if annotated else dict.fromkeys(row)
            error_px = size * frame / world.frames
            curve = {"supervision": supervision, "predictor": predictor, "frame": frame, "error_px": error_px}
            curves += [pd.DataFrame(curve)] if annotated else []
    results.save_json(folder / "predictors.json", predictors)
    row = predictors["tracks"]["dispnet"]
    followed = {"unsupervised_with_dispnet": trackers["unsupervised"]}
    state = {"unlocked": False, "score": 0.31, "tracker_px": 0.56, "forecast_px": 2.16, "forecast_loss": 2.5}
    gate = {"gained": locked, "before": state, "after": {**state, "tracker_px": 0.25}}
    tuned = {"trackers": followed, "predictors": {"dispnet": row}, "gate": gate}
    results.save_json(folder / "finetuned" / "dispnet.json", tuned)
    results.save_csv(folder / "horizons.csv", pd.concat(curves))


def build(root: Path, world: World) -> Project:
    """Writes all that the report reads, of two data sets that ran and one, `old`, that did not."""
    folders = ("clips", "truth", "tracks", "scores", "forecasts", "tracker", "predictors")
    sources = Sources(*(root / "data" / folder for folder in folders))
    _data_set(sources, world, "bowls", K=1, annotated=True, locked=True)
    _data_set(sources, world, "film", K=2, annotated=False, locked=False)
    _data_set(sources, world, "old", K=1, annotated=True, locked=True)
    run = RunParams(
        datasets=["bowls", "film"],
        simulated=["bowls"],
        learned=list(world.learned),
        supervised=["bowls"],
        flow=[],
        finetuned=[],
    )
    film = FilmParams(clips=2, frames_at_most=100, fps_at_most=30, quality=90)
    shown = ReportParams(
        predictor="dispnet",
        clips_shown=2,
        frames_shown=3,
        upscale=3,
        trail_frames=8,
        spans_shown=3,
        span_frames=4,
        coverage_percent=[50, 90],
        plate=PlateParams(reach=2, spots=2, background_frames=9),
        film=film,
    )
    return Project(world, root, sources, run, shown, LOCK, ABLATION)


@pytest.fixture(scope="session")
def project(tmp_path_factory: pytest.TempPathFactory) -> Project:
    return build(tmp_path_factory.mktemp("project"), World())


@pytest.fixture(scope="session")
def bowls(project: Project) -> Evidence:
    return project.evidence("bowls")


@pytest.fixture(scope="session")
def film(project: Project) -> Evidence:
    return project.evidence("film")


@pytest.fixture(scope="session")
def folder(project: Project, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of the made-up project."""
    out = tmp_path_factory.mktemp("out") / "report"
    write_page(out, project.every(), project.ablation, 7, project.shown, project.lock)
    return out
