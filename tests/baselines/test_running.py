"""The baselines over the clips of a data set."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.baselines.running import baseline_tracks
from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BASELINES, BaselineParams, Follower, Settings, known_flows
from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import annotations, tracks
from physpipe.io.clips import Clip, ClipSet, save

H, W, T, RADIUS_PX = 40, 64, 10, 5.0
TEMPLATE = TemplateParams(candidates=4, flat_lab=2, smoothness_per_px2=0.001, lost_score=0.4, lost_switch=1)
Run = Callable[..., dict[str, pd.DataFrame]]
PATH = np.stack([12 + 4.0 * np.arange(T), 12 + 1.5 * np.arange(T)], axis=1)


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")


@pytest.fixture
def clips(tmp_path: Path) -> ClipSet:
    """A red disc runs along PATH; clips one and two are for testing."""
    rows, columns = np.mgrid[:H, :W]
    inside = np.clip(RADIUS_PX + 0.5 - np.hypot(columns - PATH[:, :1, None], rows - PATH[:, 1:, None]), 0, 1)[..., None]
    frames = (inside * [220, 60, 40] + (1 - inside) * 110).round().astype(np.uint8)
    times, numbers, status = np.arange(T) / 80, np.arange(T, dtype=np.int32), np.array(["ok"] * T)
    made = [
        Clip(name, split, "film.mp4", Geometry(0, 0, W, H, W, H), frames, times, numbers, times, status)
        for name, split in (("one", "test"), ("other", "train"), ("two", "test"))
    ]
    save(tmp_path / "clips", made)
    return ClipSet(tmp_path / "clips")


@pytest.fixture
def run(clips: ClipSet, params: BaselineParams) -> Run:
    """Baseline tables, after a round trip through their folder."""

    def run(truth: pd.DataFrame, templates: str = "", **changes: object) -> dict[str, pd.DataFrame]:
        folder = clips.folder.parent / "annotated"
        folder.mkdir()
        if templates:
            (folder / "templates.csv").write_text(templates)
        given = annotations.load(folder, clips)
        chosen = params.model_copy(update={"names": ["lab", "persistence", "centre"], **changes})
        settings = Settings(chosen, TEMPLATE, RADIUS_PX, known_flows(chosen))
        tables = baseline_tracks(clips, given, truth, settings)
        tracks.save_folder(folder / "out", tables, "test", clips)
        return tracks.load_folder(folder / "out")

    return run


def known(*names: str, first: int = 0) -> pd.DataFrame:
    """Truth of the named clips, visible from frame `first`; a second object never shows."""
    xy = np.full((T, 2, 2), np.nan)
    xy[first:, 0] = PATH[first:]
    return pd.concat([tracks.rows(name, np.arange(T) / 80, xy, np.ones((T, 2)), "reference") for name in names])


def test_each_starts_where_the_object_first_shows_and_only_test_clips_run(run: Run) -> None:
    tables = run(known("one", "other", first=3))
    assert list(tables) == ["centre", "lab", "persistence"]
    for name, table in tables.items():
        assert set(table["clip"]) == ({"one"} if isinstance(BASELINES[name], Follower) else {"one", "two"})
    lab, still = (tracks.positions(tables[name], "one") for name in ("lab", "persistence"))
    assert np.abs(lab[3:, 0] - PATH[3:]).max() < 0.1  # pixels
    np.testing.assert_array_equal(still[3:, 0], np.tile(PATH[3].astype(np.float32), (T - 3, 1)))
    for xy in (lab, still):
        assert np.isnan(xy[:3]).all()
        assert np.isnan(xy[:, 1]).all()
    assert (tracks.positions(tables["centre"], "one") == [(W - 1) / 2, (H - 1) / 2]).all()
    assert tracks.positions(tables["centre"], "two").shape == (T, 1, 2)


def test_the_users_box_is_preferred_to_one_around_the_start(run: Run) -> None:
    wrong = "clip,object,frame,x,y,w,h\none,0,4,40,2,9,9\n"  # a flat corner: nothing correlates with it
    lab = tracks.positions(run(known("one"), wrong)["lab"], "one")
    assert np.flatnonzero(np.isfinite(lab[:, 0, 0])).tolist() == [4]


def test_without_truth_only_what_needs_no_start_runs(run: Run) -> None:
    tables = run(tracks.empty(), names=["lucas_kanade", "median_blob", "dis_simple", "centre"])
    assert list(tables) == ["centre", "median_blob"]


def test_a_finder_finds_as_many_objects_as_there_are(run: Run) -> None:
    xy = tracks.positions(run(known("one"), names=["median_blob"])["median_blob"], "one")
    assert xy.shape == (T, 2, 2)
    assert np.abs(xy[:, 0] - PATH).max() < 0.3  # pixels
    assert np.isnan(xy[:, 1]).all()  # there is no second one


def test_a_start_outside_the_frame_is_refused_naming_the_clip(run: Run) -> None:
    truth = known("one", "two")
    truth.loc[(truth["clip"] == "two") & (truth["object"] == 0), "x"] = float(W)
    with pytest.raises(InputError, match=r"clip `two`, tracker `lucas_kanade`: .* outside the frame of 64 x 40"):
        run(truth, names=["lucas_kanade"])


def test_a_template_larger_than_the_frame_is_refused_naming_the_clip(run: Run) -> None:
    with pytest.raises(InputError, match=r"clip `one`, tracker `lab`: .*larger than the frame of 64 x 40"):
        run(known("one"), names=["lab"], box_radii=4.5)
