"""docs/adding.md, done: its blocks are written into a copy of the project, and what was added is run there."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from pages import ROOT, SPAN, blocks
from worlds import BLUE, RED, draw, orbit, save_clips

from physpipe.core.ball import BallParams
from physpipe.core.horizon import PredictParams
from physpipe.core.objects import ObjectsParams
from physpipe.core.params import read
from physpipe.ingest.dataset import IngestParams
from physpipe.io import forecasts, tracks

PAGE = ROOT / "docs/adding.md"
PARTS = ("physpipe", "stages", "params.yaml", ".gitignore")
FRAMES = 30
EACH = """
import runpy, sys
for stage in sys.argv[1:]:
    name, *sys.argv[1:] = stage.split()
    runpy.run_module(f"stages.{name}", run_name="__main__")
"""


def changed(text: str, diff: str) -> str:
    """`text` after every hunk of `diff`, whose old lines must stand in it exactly once, in a row."""
    for hunk in diff.split("@@\n")[1:]:
        lines = hunk.splitlines(keepends=True)
        assert all(line[0] in " +-" for line in lines), hunk
        old, new = ("".join(line[1:] for line in lines if line[0] in signs) for signs in (" -", " +"))
        assert text.startswith(old) + text.count(f"\n{old}") == 1, f"these lines must be there once:\n{old}"
        text = text.replace(old, new, 1) if text.startswith(old) else text.replace(f"\n{old}", f"\n{new}", 1)
    return text


@dataclass(frozen=True)
class Copy:
    """A copy of the project with one section of the page done."""

    root: Path

    def do(self, section: str) -> "Copy":
        """Writes the section's blocks into the files that the prose before each of them names last."""
        for block in blocks(PAGE, section=section):
            if block.language not in ("python", "diff"):
                continue
            path = self.root / [each for each in SPAN.findall(block.before) if "." in each][-1]
            assert path.exists() == (block.language == "diff"), path
            path.write_text(changed(path.read_text(), block.text) if block.language == "diff" else block.text)
        return self

    def edit(self, **sections: dict) -> None:
        """Replaces keys of sections of params.yaml."""
        path = self.root / "params.yaml"
        params = yaml.safe_load(path.read_text())
        for name, values in sections.items():
            params[name] = params[name] | values
        path.write_text(yaml.safe_dump(params))

    def run(self, *stages: str) -> None:
        """Stages with their words, one after the other, with the copy's code; one process, as PyTorch starts slowly."""
        plain = {name: value for name, value in os.environ.items() if not name.startswith("DVC_")}
        alone = plain | {"PHYSPIPE_WORKERS": "1", "OMP_NUM_THREADS": "1"}
        done = subprocess.run(
            [sys.executable, "-c", EACH, *stages], cwd=self.root, env=alone, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr[-3000:]

    def params(self) -> dict:
        return yaml.safe_load((self.root / "params.yaml").read_text())


@pytest.fixture
def copy(tmp_path: Path) -> Copy:
    for name in PARTS:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, tmp_path / name)
    return Copy(tmp_path)


@pytest.fixture
def paths() -> list[np.ndarray]:
    """(T, 2, 2) pixels of two discs in each of five clips."""
    return [np.stack([orbit(FRAMES, n), orbit(FRAMES, n + 3)], axis=1) for n in range(5)]


def film(copy: Copy, paths: list[np.ndarray]) -> None:
    """Clips of the set `bowls`, and their true positions."""
    root = copy.root / "data"
    clips = save_clips(root / "clips/bowls", [draw(xy, [RED, BLUE], n) for n, xy in enumerate(paths)])
    rows = [
        tracks.rows(name, clips.times_s(name), xy, np.ones(xy.shape[:2]))
        for name, xy in zip(clips.names(), paths, strict=True)
    ]
    tracks.save(root / "truth/bowls.parquet", pd.concat(rows), "made up", clips)


def test_an_added_tracker_tracks_a_clip(copy, paths):
    copy.do("A tracker to compare with")
    film(copy, paths)
    assert "saturation" in copy.params()["baselines"]["names"]
    copy.edit(baselines={"names": ["saturation"]})
    copy.run("baseline_tracks bowls data/clips/bowls data/annotations/bowls data/truth/bowls.parquet found")
    ((clip, xy),) = tracks.by_clip(tracks.load(copy.root / "found/saturation.parquet")).items()
    assert clip == "clip_04"
    apart = np.linalg.norm(xy[:, :, None] - paths[4][:, None], axis=-1).min(axis=2)
    assert apart.max() < 1  # pixel


def test_an_added_predictor_learns_a_step_and_forecasts(copy, paths):
    copy.do("A predictor")
    film(copy, paths)
    params = copy.params()
    assert "coasting" in params["run"]["learned"]
    section = params["predictors"]["coasting"]
    small = section | {"fit": section["fit"] | {"steps": 1, "valid_every": 1, "batch_size": 2}}
    copy.edit(
        predictors={"coasting": small},
        datasets={"bowls": {"predict": {"horizon": 6, "interpolation": None, "mirrors": False}}},
    )
    known = "bowls coasting data/clips/bowls data/truth/bowls.parquet model"
    copy.run(f"train_predictor {known}", f"forecast {known} ahead.parquet")
    table = forecasts.load(copy.root / "ahead.parquet")
    assert table["frame"].agg(["min", "max"]).tolist() == [2, 24]
    first = table[table["frame"] == 2].sort_values("object")[["x", "y"]].to_numpy()
    straight = 2 * paths[4][1] - paths[4][0]
    np.testing.assert_allclose(first, straight, atol=0.2)  # pixels; it has lost a few hundredths of its pace


def test_an_added_world_is_filmed_and_its_section_is_whole(copy):
    copy.do("A world")
    path = copy.root / "params.yaml"
    for part, kind in {
        "ingest": IngestParams,
        "motion": ObjectsParams,
        "evaluate": BallParams,
        "predict": PredictParams,
    }.items():
        read(f"datasets.dish.{part}", kind, path)
    params = copy.params()
    section = params["datasets"]["dish"]
    copy.edit(
        datasets={
            "dish": section
            | {"simulate": section["simulate"] | {"sizes": {"default": {"clips": 1, "moving_frames": 60}}}}
        }
    )
    copy.run("simulate dish raw said")
    assert [each.name for each in (copy.root / "raw").iterdir()] == ["clip_0000.mp4"]
    xy = pd.read_csv(copy.root / "said/reference.csv")
    assert len(xy) >= 60
    assert xy["x"].between(0, 192).all()
    assert xy["y"].between(0, 160).all()
    assert np.hypot(*xy[["x", "y"]].diff().to_numpy()[1:].T).max() > 0.3  # pixels a frame: it rolls
    camera, ingest = params["presets"]["cameras"]["handheld"], section["ingest"]
    scale = ingest["size"] / min(camera["width"], camera["height"])
    radius_px = section["simulate"]["balls"]["radius_m"][0] * camera["pixels_per_metre"] * scale
    assert section["evaluate"]["ball_radius_px"] == pytest.approx(radius_px, abs=0.05)
    assert "/data/annotations/dish/" in (copy.root / ".gitignore").read_text().splitlines()


def test_a_change_that_does_not_fit_says_so():
    assert changed("a\nb\n", "@@\n a\n+c\n b\n") == "a\nc\nb\n"
    for text in ("b\n", "a\na\n"):
        with pytest.raises(AssertionError, match="must be there once"):
            changed(text, "@@\n a\n+c\n")
