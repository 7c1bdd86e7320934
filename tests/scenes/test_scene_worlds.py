import io
from pathlib import Path

import av
import numpy as np
import pandas as pd
import pytest
import yaml

from physpipe.core import params
from physpipe.core.errors import InputError
from physpipe.scenes.film import Camera
from physpipe.scenes.physics import DENSITY
from physpipe.scenes.worlds import WorldParams, record, simulate, track
from stages.simulate import main

PARAMS = Path(__file__).parents[2] / "params.yaml"
PAPER_PX = {1: (20.0, 62.0), 2: (12.0, 93.0)}
"""Degree of the polynomial: mean error at frames 20 and 40 that the paper prints for BowlS."""


def decode(video: bytes) -> np.ndarray:
    with av.open(io.BytesIO(video)) as container:
        return np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]).astype(float)


def extrapolated(xy: np.ndarray, degree: int, frame: int) -> np.ndarray:
    """(clips, 2) least-squares polynomial of the first 10 of (clips, F, 2) positions, at a later frame."""
    weights = np.vander([frame], degree + 1) @ np.linalg.pinv(np.vander(np.arange(10.0), degree + 1))
    return np.einsum("f,cfd->cd", weights[0], xy[:, :10])


def filmed(world: WorldParams, number: int) -> np.ndarray:
    """(F, K, 2) source pixels from the release on, the camera's wobble included, which no polynomial foresees."""
    xyz = track(world, "bowls", number).xyz_m
    return Camera(world.camera, len(xyz), np.random.default_rng(number)).project(xyz)


def test_bowls_moves_as_hard_as_the_papers() -> None:
    """What "error at T" means depends on the motion: both extrapolations must err as they did in the paper."""
    bowls = params.read("datasets.bowls.simulate", WorldParams, PARAMS)
    scale = 128 / params.read_value("datasets.bowls.ingest.crop", PARAMS)["width"]
    xy = scale * np.stack([filmed(bowls, number)[:123:3, 0] for number in range(120)])
    for degree, errors in PAPER_PX.items():
        for frame, paper in zip((20, 40), errors, strict=True):
            error = np.linalg.norm(extrapolated(xy, degree, frame) - xy[:, frame], axis=1).mean()
            assert error == pytest.approx(paper, rel=0.15), (degree, frame)


def test_bowls_without_friction_keeps_its_energy_within_one_percent() -> None:
    bowls = params.read("datasets.bowls.simulate", WorldParams, PARAMS)
    smooth = bowls.physics.model_copy(update={"friction": 0, "rolling_resistance_m": 0})
    lossless, radius = bowls.model_copy(update={"physics": smooth}), bowls.balls.radius_m
    for number in range(12):
        at_rest = DENSITY * 4 / 3 * np.pi * radius**3 * smooth.gravity_m_s2 * radius  # at the bottom of the bowl
        energy = track(lossless, "bowls", number).energy_j - at_rest
        assert np.abs(energy / energy[0] - 1).max() < 0.01


def test_most_pairs_of_balls_meet() -> None:
    bowls2 = params.read("datasets.bowls2.simulate", WorldParams, PARAMS)
    nearest = []
    for number in range(40):
        xyz = track(bowls2, "bowls2", number).xyz_m
        nearest.append(np.linalg.norm(xyz[:, 0] - xyz[:, 1], axis=1).min() / bowls2.balls.radius_m)
    assert np.mean(np.array(nearest) < 3) > 0.6  # centres within three radii: touching is two
    assert min(nearest) > 1.5  # and never through each other


def test_clip_is_the_same_whenever_it_is_made(world: WorldParams) -> None:
    first, again = record(world, "somewhere", 1), record(world, "somewhere", 1)
    assert first.video == again.video
    np.testing.assert_array_equal(first.xy, again.xy)
    in_order = list(simulate(world, "somewhere"))
    assert [each.source for each in in_order] == ["clip_0000.mp4", "clip_0001.mp4"]
    assert in_order[1].video == first.video
    assert record(world, "elsewhere", 1).video != first.video


def test_balls_wait_and_then_move(world: WorldParams) -> None:
    calm = world.model_copy(update={"camera": world.camera.model_copy(update={"wobble_px": 0})})
    for number in range(4):
        xy = record(calm, "calm", number).xy
        still = len(xy) - calm.moving_frames
        assert calm.still_frames[0] <= still <= calm.still_frames[1]
        assert np.ptp(xy[: still + 1], axis=0).max() == 0
        assert np.linalg.norm(xy[still + 1] - xy[still], axis=1).min() > 0.05


def test_track_is_the_motion_of_the_film(world: WorldParams) -> None:
    calm = world.model_copy(update={"camera": world.camera.model_copy(update={"wobble_px": 0})})
    moved = np.diff(record(calm, "calm", 2).xy[-calm.moving_frames :], axis=0)
    metres = np.diff(track(calm, "calm", 2).xyz_m[..., :2], axis=0)
    np.testing.assert_allclose(moved, metres * calm.camera.pixels_per_metre, atol=1e-9)


def test_truth_is_where_the_ball_is_seen(world: WorldParams) -> None:
    """In the decoded film, wobble and all, the middle of what is redder than the rest is the truth to 0.25 px."""
    flat = world.look.model_copy(update={"ambient": 1, "gloss": 0})  # else the lit side pulls the middle
    one = world.model_copy(update={"balls": world.balls.model_copy(update={"rgb": [(255, 30, 20)]}), "look": flat})
    recording = record(one, "seen", 0)
    frames = decode(recording.video)
    assert len(frames) == len(recording.xy)
    red = np.clip(frames[..., 0] - frames[..., 1:].max(axis=3) - 60, 0, None)
    rows, columns = np.indices(red.shape[1:])
    seen = np.stack([(red * columns).sum((1, 2)), (red * rows).sum((1, 2))], axis=1) / red.sum((1, 2))[:, None]
    error = np.linalg.norm(seen - recording.xy[:, 0], axis=1)
    assert np.percentile(error, 95) < 0.25


def test_stage_writes_videos_and_truth(world: WorldParams, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    section = {"datasets": {"tiny": {"simulate": world.model_dump(mode="json")}}}
    Path("params.yaml").write_text(yaml.safe_dump(section))
    main("tiny", tmp_path / "raw/tiny", tmp_path / "annotations/tiny")
    truth = pd.read_csv("annotations/tiny/reference.csv")
    assert list(truth.columns) == ["source", "object", "frame", "x", "y"]
    for source, rows in truth.groupby("source"):
        frames = decode((tmp_path / "raw/tiny" / str(source)).read_bytes())
        assert sorted(zip(rows["object"], rows["frame"], strict=True)) == [
            (ball, frame) for ball in (0, 1) for frame in range(len(frames))
        ]
    assert sorted(path.name for path in Path("raw/tiny").iterdir()) == sorted(truth["source"].unique())


def test_impossible_world_is_refused_by_name(world: WorldParams) -> None:
    wild = world.model_copy(update={"balls": world.balls.model_copy(update={"start_speed_m_s": (50, 60)})})
    with pytest.raises(InputError, match="lower the start speed"):
        track(wild, "wild", 0)
