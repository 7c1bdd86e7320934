"""A project with film, clips, tracks and forecasts of a set `balls`, which the commands are run in."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML
from worlds import ball_film, encoded

from physpipe import cli
from physpipe.core.geometry import Geometry
from physpipe.io import clips, forecasts, tracks
from physpipe.io.clips import Clip, ClipSet

ROOT = Path(__file__).parents[2]
FRAMES = 12
Run = Callable[..., str]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The root, which is the current folder; params.yaml is the shipped one with a set more."""
    root = tmp_path / "project"
    root.mkdir()
    shutil.copy(ROOT / "params.yaml", root)
    monkeypatch.chdir(root)
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    monkeypatch.setattr("physpipe.commands.add.ask", lambda *words: "")  # takes a second; one test asks the real DVC
    return root


@pytest.fixture
def run(project: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs a command in the project; what it prints."""

    def command(*words: object) -> str:
        monkeypatch.setattr("sys.argv", ["physpipe", *map(str, words)])
        cli.main()
        return capsys.readouterr().out

    return command


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """A user's folder: a ball that swings through 200 frames of two recordings."""
    t = np.arange(100)[:, None]
    xy = np.stack([30 + 8 * np.sin(t / 25), 30 + 12 * np.sin(t / 12)], axis=-1)
    for name in ("a.mkv", "deep/b.mkv"):
        encoded(tmp_path / "film" / name, ball_film(xy, 5.0, 3, height=60, width=90), t[:, 0] / 100)
    return tmp_path / "film"


@pytest.fixture
def balls(project: Path) -> ClipSet:
    """Film, clips, tracks and forecasts of `balls`, scaled 200 px a metre; one clip for training, one for testing."""
    yaml = YAML()
    params = yaml.load(project / "params.yaml")
    params["datasets"]["balls"] = {
        "evaluate": {"ball_radius_px": 4.0},
        "scale": {"pixels_per_metre": 200.0},
    }
    yaml.dump(params, project / "params.yaml")
    t = np.arange(FRAMES)
    xy = np.stack([20 + 2.0 * t, 20 + 1.0 * t], axis=1)[:, None]
    pictures = ball_film(xy, 4.0, 3, height=48, width=64)
    encoded(project / "data/raw/balls/one.mkv", pictures, t / 50)
    encoded(project / "data/raw/balls/two.mkv", pictures, t / 50)
    geometry, ok = Geometry(0, 0, 64, 48, 64, 48), np.full(FRAMES, "ok")
    clips.save(
        project / "data/clips/balls",
        [
            Clip(f"{stem}_00", split, f"{stem}.mkv", geometry, pictures, t / 50, t.astype(np.int32), t / 50, ok)
            for stem, split in (("one", "train"), ("two", "test"))
        ],
    )
    clip_set = ClipSet(project / "data/clips/balls")
    table = [tracks.rows(name, t / 50, xy, np.full((FRAMES, 1), 0.5)) for name in clip_set.names()]
    for place in ("tracks", "truth"):
        tracks.save(project / f"data/{place}/balls.parquet", pd.concat(table), "made up", clip_set)
    ahead = forecasts.rows("two_00", 4, xy[4:] + 3.0)
    forecasts.save(project / "data/forecasts/balls/tracks/dispnet.parquet", ahead, "made up", 4, 5)
    return clip_set
