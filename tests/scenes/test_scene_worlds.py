import io
from pathlib import Path

import av
import numpy as np
import pandas as pd
import pytest
import yaml
from simulated import of_the_project

from physpipe.core.errors import InputError
from physpipe.scenes.balls import Ball
from physpipe.scenes.film import Camera
from physpipe.scenes.look import Light
from physpipe.scenes.physics import DENSITY
from physpipe.scenes.render import Scene, draw_terrain
from physpipe.scenes.world_params import WorldParams
from physpipe.scenes.worlds import Chances, draw_balls, record, simulate, surface_rng, terrain_of, track
from stages.simulate import main

FIXED = ("poolr_sim", "bowlr_sim", "heightr_sim")


def decode(video: bytes) -> np.ndarray:
    with av.open(io.BytesIO(video)) as container:
        return np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]).astype(float)


@pytest.mark.parametrize("name", ["bowls", "heights"])
def test_energy_without_friction_is_kept_within_one_percent(name: str) -> None:
    world = of_the_project(name)
    smooth = world.physics.model_copy(update={"friction": 0, "rolling_resistance_m": 0})
    lossless, radius = world.model_copy(update={"physics": smooth}), world.balls.radius_m[0]
    for number in range(12):
        at_rest = DENSITY * 4 / 3 * np.pi * radius**3 * smooth.gravity_m_s2 * radius  # where the ground is lowest
        energy = track(lossless, name, number).energy_j - at_rest
        assert np.abs(energy / energy[0] - 1).max() < 0.01


@pytest.mark.parametrize(("name", "most"), [("bowls2", 0.6), ("heightr2_sim", 0.2)])
def test_many_pairs_of_balls_meet(name: str, most: float) -> None:
    world, gaps = of_the_project(name), []
    for number in range(24):
        radii = sum(ball.radius_m for ball in draw_balls(world, Chances.of(name, number).balls))
        xyz = track(world, name, number).xyz_m
        gaps.append(np.linalg.norm(xyz[:, 0] - xyz[:, 1], axis=1).min() / radii)
    assert np.mean(np.array(gaps) < 1.05) > most  # distance of the centres over that of touching
    assert min(gaps) > 0.75  # and never through each other


def test_heights_differ_between_clips_and_fixed_ones_do_not() -> None:
    """Terrains of all 24 clips looked at differ pairwise by more than 1 cm somewhere; a fixed set has one."""
    side = np.linspace(-0.12, 0.12, 15)
    x, y = np.meshgrid(side, side)
    fresh, fixed = of_the_project("heights"), of_the_project("heightr_sim")
    drawn = np.stack([terrain_of(fresh, Chances.of("heights", k)).height(x, y) for k in range(24)])
    same = np.stack([terrain_of(fixed, Chances.of("heightr_sim", k)).height(x, y) for k in range(3)])
    apart = np.abs(drawn[:, None] - drawn).max(axis=(2, 3)) + np.diag(np.full(len(drawn), np.inf))
    assert apart.min() > 0.01
    assert np.ptp(same, axis=0).max() == 0
    other = terrain_of(fixed, Chances.of("heightr2_sim", 0)).height(x, y)
    assert np.abs(other - same[0]).max() > 0.01


@pytest.mark.parametrize("name", FIXED)
def test_fixed_surface_looks_alike_in_every_clip(name: str) -> None:
    """Under one lamp from one place, with the balls out of the way, two clips' first pictures are the same."""
    world = of_the_project(name)
    backgrounds = []
    for number in (0, 1):
        chances = Chances.of(name, number)
        camera = Camera(world.camera.model_copy(update={"off_centre_px": 0}), 2, chances.film)
        lamp = Light(np.array([0.0, 0.0, 1.0]))
        terrain = terrain_of(world, chances)
        backgrounds.append(draw_terrain(world.look, terrain, camera, lamp, surface_rng(world, chances)))
    np.testing.assert_array_equal(*backgrounds)
    assert backgrounds[0].std() > 3  # grey levels: and there is something to see


def test_colours_and_radii_are_drawn_for_each_clip() -> None:
    one, two, same = (of_the_project(name) for name in ("heightr_sim", "heightr2_sim", "heightr2_same_sim"))
    drawn = [draw_balls(one, np.random.default_rng(k))[0] for k in range(60)]
    assert {ball.rgb for ball in drawn} == set(one.palette)
    low, high = one.balls.radius_m
    assert all(low <= ball.radius_m <= high for ball in drawn)
    assert np.ptp([ball.radius_m for ball in drawn]) > 0.8 * (high - low)
    for k in range(20):
        assert len({ball.rgb for ball in draw_balls(two, np.random.default_rng(k))}) == 2
        assert len({ball.rgb for ball in draw_balls(same, np.random.default_rng(k))}) == 1
    listed = of_the_project("bowls2")
    assert [ball.rgb for ball in draw_balls(listed, np.random.default_rng(0))] == listed.palette[:2]


@pytest.mark.parametrize("name", ["poolr_sim", "bowlr_sim", "heightr_sim", "heightr2_sim", "heightr2_same_sim"])
def test_stand_ins_have_the_papers_balls(name: str) -> None:
    """Seven colours, 3.2 to 6.4 px in radius in a 128-px frame."""
    world = of_the_project(name)
    scale = world.camera.pixels_per_metre * 128 / min(world.camera.width, world.camera.height)
    np.testing.assert_allclose(scale * np.array(world.balls.radius_m), [3.2, 6.4], atol=0.05)
    assert len(set(world.palette)) == 7


@pytest.mark.parametrize("name", ["heights", *FIXED])
def test_drawn_ball_is_where_truth_says(name: str) -> None:
    """The middle of what the ball's colour changes in the picture is the projected truth, smeared or not, to 0.1 px."""
    world = of_the_project(name)
    world = world.model_copy(update={"moving_frames": 40, "look": world.look.model_copy(update={"ambient": 1})})
    chances = Chances.of(name, 0)
    radius = draw_balls(world, chances.balls)[0].radius_m
    xyz = track(world, name, 0).xyz_m
    camera = Camera(world.camera, len(xyz), np.random.default_rng(0))
    xy = camera.project(xyz)
    scene = Scene(world.look, terrain_of(world, chances), camera, np.random.default_rng(1), np.random.default_rng(2))
    red, black = (np.stack(list(scene.film(xyz, xy, [Ball(rgb, radius)])))[..., 0] for rgb in ((255, 0, 0), (0, 0, 0)))
    cover = (red - black).astype(float)
    rows, columns = np.indices(cover.shape[1:])
    seen = np.stack([(cover * columns).sum((1, 2)), (cover * rows).sum((1, 2))], axis=1) / cover.sum((1, 2))[:, None]
    assert np.linalg.norm(seen - xy[:, 0], axis=1).max() < 0.1


def test_ball_starts_clear_of_the_cushions() -> None:
    world = of_the_project("poolr_sim")
    corner = world.model_copy(update={"balls": world.balls.model_copy(update={"start_level": (0.0, 1.0)})})
    a, b = np.array(corner.terrain.half_sides_m)
    for number in range(30):
        radius = draw_balls(corner, Chances.of("corner", number).balls)[0].radius_m
        x, y = np.abs(track(corner.model_copy(update={"moving_frames": 2}), "corner", number).xyz_m[0, 0, :2])
        assert max(x - a, y - b) < -1.2 * radius


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
    ball = world.balls.model_copy(update={"count": 1})
    one = world.model_copy(update={"balls": ball, "palette": [(255, 30, 20)], "look": flat})
    recording = record(one, "seen", 0)
    frames = decode(recording.video)
    assert len(frames) == len(recording.xy)
    red = np.clip(frames[..., 0] - frames[..., 1:].max(axis=3) - 60, 0, None)
    rows, columns = np.indices(red.shape[1:])
    seen = np.stack([(red * columns).sum((1, 2)), (red * rows).sum((1, 2))], axis=1) / red.sum((1, 2))[:, None]
    error = np.linalg.norm(seen - recording.xy[:, 0], axis=1)
    assert np.percentile(error, 95) < 0.25


def sections(name: str, world: dict) -> dict:
    """Sections of params.yaml that describe `world`, with every preset called `mine`."""
    kinds = {"terrain": "terrains", "physics": "physics", "palette": "palettes", "look": "looks", "camera": "cameras"}
    own = {"balls": world["balls"], "still_frames": world["still_frames"], "size": "tiny"}
    size = {"tiny": {key: world[key] for key in ("clips", "moving_frames")}}
    simulated = own | {"sizes": size} | dict.fromkeys(kinds, "mine")
    presets = {plural: {"mine": world[key]} for key, plural in kinds.items()}
    return {"presets": presets, "datasets": {name: {"simulate": simulated}}}


def test_stage_writes_videos_and_truth(world: WorldParams, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    Path("params.yaml").write_text(yaml.safe_dump(sections("tiny", world.model_dump(mode="json"))))
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
