"""Where truth comes from, and that corrections change nothing else."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.baselines.ground_truth import ground_truth
from physpipe.baselines.template import TemplateParams
from physpipe.core.geometry import Geometry
from physpipe.io import annotations, tracks
from physpipe.io.clips import Clip, ClipSet, save

H, W, T = 48, 64, 12
GEOMETRY = Geometry(30, 10, 3 * W, 3 * H, W, H)
PARAMS = TemplateParams(candidates=4, flat_lab=2, smoothness_per_px2=0.001, lost_score=0.4, lost_switch=1)


def path(k: int) -> np.ndarray:
    """(T, 2): disc k runs to the right, the second one lower and slower."""
    t = np.arange(T)
    return np.stack([12 + (3 - k) * t, 14 + 18 * k + 0.3 * t], axis=1)


def frames() -> np.ndarray:
    rows, columns = np.mgrid[:H, :W]
    film = np.full((T, H, W, 3), 110.0)
    for k, colour in enumerate(([220, 60, 40], [40, 90, 210])):
        for t, (x, y) in enumerate(path(k)):
            inside = np.clip(5 - np.hypot(columns - x, rows - y), 0, 1)[..., None]
            film[t] = inside * colour + (1 - inside) * film[t]
    return film.round().astype(np.uint8)


@pytest.fixture
def clips(tmp_path: Path) -> ClipSet:
    times, numbers, status = np.arange(T) / 80, 5 + np.arange(T, dtype=np.int32), np.array(["ok"] * T)
    save(
        tmp_path / "clips",
        [Clip(n, "test", f"{n}.mp4", GEOMETRY, frames(), times, numbers, times, status) for n in ("a", "b")],
    )
    return ClipSet(tmp_path / "clips")


TEMPLATES = "clip,object,frame,x,y,w,h\na,0,0,5,7,15,15\na,1,0,5,25,15,15\n"


def truth(clips: ClipSet, **files: str) -> pd.DataFrame:
    """The truth that CSV texts, named by file, give; checked as `tracks.save` checks it."""
    folder = clips.folder.parent / "annotated"
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / f"{name}.csv").write_text(text)
    table = ground_truth(clips, annotations.load(folder, clips), PARAMS)
    tracks.save(folder / "truth.parquet", table, "test", clips)
    return tracks.load(folder / "truth.parquet")


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")


def test_boxes_give_tracks_of_the_annotated_clips_only(clips: ClipSet) -> None:
    table = truth(clips, templates=TEMPLATES)
    assert set(table["clip"]) == {"a"}
    expected = np.stack([path(0), path(1)], axis=1)
    assert np.abs(tracks.positions(table, "a") - expected).max() < 0.1  # pixels
    assert set(table["status"]) == {"tracked"}


def test_corrections_replace_their_rows_and_no_others(clips: ClipSet) -> None:
    plain = truth(clips, templates=TEMPLATES)
    said = "clip,object,frame,x,y,visible\na,1,4,20.5,30.25,true\na,0,7,,,false\n"
    table = truth(clips, templates=TEMPLATES, corrections=said)
    changed = (table["status"] == "corrected").to_numpy()
    pd.testing.assert_frame_equal(table[~changed], plain[~changed])
    rows = table[changed].set_index(["object", "frame"])
    assert rows.index.tolist() == [(0, 7), (1, 4)]
    assert rows.loc[(1, 4), ["x", "y", "score", "visible"]].tolist() == [20.5, 30.25, 1, True]
    assert rows.loc[(0, 7), ["x", "y"]].isna().all()
    assert not rows.loc[(0, 7), "visible"]


def test_an_object_known_by_corrections_alone_is_lost_elsewhere(clips: ClipSet) -> None:
    table = truth(clips, corrections="clip,object,frame,x,y,visible\nb,0,2,3,4,yes\n")
    assert table["visible"].tolist() == [frame == 2 for frame in range(T)]
    assert table["status"].tolist() == ["corrected" if frame == 2 else "lost" for frame in range(T)]


def test_reference_positions_pass_through_the_geometry_exactly(clips: ClipSet) -> None:
    numbers, source = 5 + np.arange(T), GEOMETRY.to_source(path(0))
    rows = [f"b.mp4,0,{n},{x},{y},{'hand' if n == 8 else ''}" for n, (x, y) in zip(numbers, source, strict=True)]
    said = "\n".join(["source,object,frame,x,y,tag", *rows])
    corrected = "clip,object,frame,x,y,visible\nb,0,1,9,9,true\n"
    table = truth(clips, templates=TEMPLATES, reference=said, corrections=corrected)
    assert set(table["clip"]) == {"a", "b"}  # the boxes still serve where no reference does
    b = table[table["clip"] == "b"].reset_index(drop=True)
    expected = path(0)
    expected[1] = 9
    np.testing.assert_allclose(b[["x", "y"]], expected, atol=1e-5)  # pixels: float32
    assert b["status"].tolist() == ["reference", "corrected", *["reference"] * (T - 2)]
    assert np.flatnonzero(b["tag"] == "hand").tolist() == [3]


def test_film_that_nobody_annotated_has_an_empty_truth_and_a_warning(
    clips: ClipSet, capsys: pytest.CaptureFixture[str]
) -> None:
    assert truth(clips).empty
    assert "warning" in capsys.readouterr().err
