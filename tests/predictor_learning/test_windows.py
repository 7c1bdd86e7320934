import numpy as np
import pandas as pd
import pytest
import torch

from physpipe.core.determinism import torch_generator
from physpipe.core.errors import InputError
from physpipe.core.geometry import Geometry
from physpipe.io import clips, tracks
from physpipe.io.clips import Clip, ClipSet
from physpipe.predictor_learning.mirrors import mirrored
from physpipe.predictor_learning.windows import TrackWindows, WindowParams

LENGTH, OBJECTS = 12, 2
SYMMETRIES = [(x, y, swap) for x in (False, True) for y in (False, True) for swap in (False, True)]


def made(folder, height=20, width=28, lost=()):
    """Two training clips and a validation one: a lit pixel a frame for each object, and tracks that say where.

    `lost`: (clip number, frame) at which object 1 is not tracked.
    """
    generator = np.random.default_rng(0)
    tables, films = [], []
    for number, split in enumerate(["train", "train", "valid"]):
        xy = generator.integers(0, [width, height], (LENGTH, OBJECTS, 2))
        frames = np.zeros((LENGTH, height, width, 3), np.uint8)
        for k in range(OBJECTS):
            frames[np.arange(LENGTH), xy[:, k, 1], xy[:, k, 0], k] = 200
        positions = xy.astype(np.float32)
        for clip, frame in lost:
            if clip == number:
                positions[frame, 1] = np.nan
        times = np.arange(LENGTH) / 80
        films.append(
            Clip(
                f"c{number}", split, "film.mp4", Geometry(0, 0, width, height, width, height), frames, times,
                np.arange(LENGTH, dtype=np.int32), times, np.full(LENGTH, "ok"),
            )
        )  # fmt: skip
        tables.append(tracks.rows(f"c{number}", times, positions, np.ones((LENGTH, OBJECTS))))
    clips.save(folder, films)
    return ClipSet(folder), pd.concat(tables)


def windows(folder, split="train", seen_frames=4, horizon=8, sees_end=False, **world):
    found, table = made(folder, **world)
    return TrackWindows(found, table, split, seen_frames, horizon, sees_end)


def drawing(noise_px=0.0, first_share=0.0):
    return WindowParams(noise_px=noise_px, first_share=first_share, valid_windows=8)


def lit(frames: np.ndarray, colour: int) -> np.ndarray:
    """(T, 2) x, y of the lit pixel of a colour in frames (T, H, W, 3)."""
    return np.argwhere(frames[..., colour] > 0)[:, [2, 1]]


def test_every_stretch_of_horizon_plus_one_frames_counts(tmp_path):
    found = windows(tmp_path / "set")
    assert len(found) == 2 * (LENGTH - 8)
    batch = found.batch(range(len(found)))
    assert batch.seen.frames.shape == (8, 4, 3, 20, 28)
    assert batch.seen.times[0].tolist() == [0, 1, 2, 3]
    assert batch.asked_times[0].tolist() == [4, 5, 6, 7, 8]
    assert batch.target.shape == (8, 5, OBJECTS, 2)


def test_seen_frames_show_the_objects_at_the_seen_positions(tmp_path):
    batch = windows(tmp_path / "set").batch([1, 6])
    for frames, xy in zip(batch.seen.frames, batch.seen.xy, strict=True):
        for k in range(OBJECTS):
            np.testing.assert_array_equal(lit(frames.permute(0, 2, 3, 1).numpy(), k), xy[:, k].numpy())


def test_steady_positions_are_those_in_the_last_seen_frame(tmp_path):
    found, table = made(tmp_path / "set")
    steady = TrackWindows(found, table, "train", 4, 8, steady=True)
    way = np.arange(LENGTH, dtype=np.float32)[:, None] * np.array([0.5, -0.25], np.float32)
    steady.camera = [way] * 2
    batch, xy = steady.batch([2]), tracks.by_clip(table)["c0"]
    expected = xy[2:11] - (way[2:11] - way[5])[:, None]
    np.testing.assert_allclose(torch.cat([batch.seen.xy[0], batch.target[0]]), expected, atol=1e-5)  # px
    assert batch.seen.steady
    assert steady.draw(2, drawing(), torch_generator(0)).seen.steady
    assert not windows(tmp_path / "shaken").batch([2]).seen.steady


def test_the_whole_track_of_the_clip_goes_with_a_window_in_its_coordinates(tmp_path):
    found = windows(tmp_path / "set", lost=[(1, 11)])
    found.xy[0] = found.xy[0][:10]
    batch = found.batch([1, 5])  # from frames 1 of clip 0 and 1 of clip 1
    assert batch.track.shape == (2, LENGTH, OBJECTS, 2)
    torch.testing.assert_close(batch.track[:, 1:10], torch.cat([batch.seen.xy, batch.target], dim=1))
    assert batch.track[0, 10:].isnan().all()
    assert batch.track[1, 11, 1].isnan().all()
    turned = found.batch([1, 5], [(True, False, False)] * 2)
    mirror = torch.stack([27 - batch.track[..., 0], batch.track[..., 1]], dim=-1)
    torch.testing.assert_close(turned.track, mirror, equal_nan=True)


def test_the_end_is_seen_by_a_frame_that_shows_the_last_target_and_by_no_position(tmp_path):
    found = windows(tmp_path / "set", sees_end=True)
    for batch in (found.batch([1, 6]), found.draw(16, drawing(), torch_generator(3))):
        assert batch.seen.times[0].tolist() == [0, 1, 2, 3, 8]
        assert batch.asked_times[0].tolist() == [4, 5, 6, 7, 8]
        assert batch.seen.xy.shape[1] == 4
        ends = torch.cat([batch.seen.xy, batch.target[:, -1:]], 1)
        for frames, xy in zip(batch.seen.frames, ends, strict=True):
            for k in range(OBJECTS):
                np.testing.assert_array_equal(lit(frames.permute(0, 2, 3, 1).numpy(), k), xy[:, k].numpy())


def test_seeing_the_end_changes_no_draw(tmp_path):
    plain, ending = (windows(tmp_path / str(sees_end), sees_end=sees_end) for sees_end in (False, True))
    drawn = [each.draw(16, drawing(noise_px=0.5), torch_generator(5, 7)) for each in (plain, ending)]
    assert torch.equal(drawn[0].target, drawn[1].target)
    assert torch.equal(drawn[0].seen.xy, drawn[1].seen.xy)
    assert torch.equal(drawn[0].seen.frames, drawn[1].seen.frames[:, :4])


@pytest.mark.parametrize("how", SYMMETRIES)
def test_mirrors_and_turns_move_frames_and_positions_together(how):
    generator = np.random.default_rng(1)
    xy = generator.integers(0, [9, 6], (5, 1, 2))
    frames = np.zeros((5, 6, 9, 3), np.uint8)
    frames[np.arange(5), xy[:, 0, 1], xy[:, 0, 0], 0] = 1
    turned, moved = mirrored(frames, xy.astype(np.float32), how)
    np.testing.assert_array_equal(lit(turned, 0), moved[:, 0])


def test_the_eight_symmetries_are_all_different():
    frames = np.arange(2 * 3 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3, 3)
    seen = {mirrored(frames, np.zeros((2, 1, 2), np.float32), how)[0].tobytes() for how in SYMMETRIES}
    assert len(seen) == 8


def test_later_frames_and_positions_never_reach_what_is_seen(tmp_path):
    found = windows(tmp_path / "set", horizon=11)
    before = found.batch([0]).seen
    found.frames[0] = np.where(np.arange(LENGTH)[:, None, None, None] < 4, found.frames[0], 255)
    found.xy[0] = np.where(np.arange(LENGTH)[:, None, None] < 4, found.xy[0], 0)
    after = found.batch([0]).seen
    assert torch.equal(before.frames, after.frames)
    assert torch.equal(before.xy, after.xy)


def test_windows_with_a_lost_object_are_left_out_and_counted(tmp_path):
    found = windows(tmp_path / "set", lost=[(0, 2)])
    assert found.skipped == 3  # starts 0, 1, 2 of clip 0 hold frame 2
    assert len(found) == 2 * (LENGTH - 8) - 3
    assert found.batch(range(len(found))).target.isfinite().all()


def test_draws_turn_square_frames_and_only_mirror_others(tmp_path):
    for name, height, width in (("wide", 20, 28), ("square", 20, 20)):
        found = windows(tmp_path / name, height=height, width=width)
        drawn = found.draw(32, drawing(), torch_generator(3))
        assert drawn.seen.frames.shape == (32, 4, 3, height, width)
        for frames, xy in zip(drawn.seen.frames, drawn.seen.xy, strict=True):
            np.testing.assert_array_equal(lit(frames.permute(0, 2, 3, 1).numpy(), 0), xy[:, 0].numpy())


def test_a_draw_depends_on_its_generator_alone_and_noise_spares_the_target(tmp_path):
    found = windows(tmp_path / "set")
    quiet, noisy = (found.draw(16, drawing(noise_px=noise), torch_generator(5, 7)) for noise in (0.0, 0.5))
    assert torch.equal(quiet.target, noisy.target)
    assert torch.equal(quiet.seen.frames, noisy.seen.frames)
    assert (noisy.seen.xy - quiet.seen.xy).std().item() == pytest.approx(0.5, rel=0.2)  # px; of 256 draws


@pytest.mark.parametrize(("lost", "share"), [([], 1.0), ([(0, 2)], 1.0), ([(0, 2), (1, 2)], 0.0)])
def test_windows_from_the_clips_beginnings_are_drawn_by_their_share_where_they_can_be_used(tmp_path, lost, share):
    found = windows(tmp_path / "set", lost=lost)
    drawn = found.pick(40, 1.0, torch_generator(1))
    assert np.mean(found.index[drawn, 1] == 0) == share
    half = found.pick(40, 0.5, torch_generator(1))
    assert share * 20 <= (found.index[half, 1] == 0).sum() < 40


def test_early_windows_are_those_that_begin_soonest_in_their_clips(tmp_path):
    found = windows(tmp_path)
    assert [found.index[number].tolist() for number in found.early(3)] == [[0, 0], [1, 0], [0, 1]]
    assert sorted(found.early(100)) == list(range(8))


def test_evenly_spread_windows_reach_both_ends(tmp_path):
    found = windows(tmp_path / "set")
    assert found.evenly(3).tolist() == [0, 4, 7]
    assert found.evenly(100).tolist() == list(range(8))


@pytest.mark.parametrize(
    ("seen_frames", "horizon", "lost", "reason"),
    [
        (4, LENGTH, [], "13 consecutive frames"),
        (4, 8, [(0, 5), (1, 5)], "9 consecutive frames"),
        (10, 9, [], "is one of the 10"),
    ],
)
def test_nothing_to_learn_from_is_an_input_error(tmp_path, seen_frames, horizon, lost, reason):
    with pytest.raises(InputError, match=reason):
        windows(tmp_path / "set", seen_frames=seen_frames, horizon=horizon, lost=lost)


def test_a_clip_without_tracks_is_an_input_error(tmp_path):
    found, table = made(tmp_path / "set")
    with pytest.raises(InputError, match="no tracks of clip c1"):
        TrackWindows(found, table[table["clip"] != "c1"], "train", 4, 8)


def test_clips_with_different_numbers_of_objects_are_an_input_error(tmp_path):
    found, table = made(tmp_path / "set")
    fewer = table[(table["clip"] != "c1") | (table["object"] == 0)]
    with pytest.raises(InputError, match="objects"):
        TrackWindows(found, fewer, "train", 4, 8)


def test_film_that_could_not_be_mirrored_is_drawn_as_it_is(tmp_path):
    found = windows(tmp_path / "set", height=20, width=20)
    found.mirrors = False
    numbers = found.pick(32, drawing().first_share, torch_generator(3))
    drawn = found.draw(32, drawing(), torch_generator(3))
    assert torch.equal(drawn.seen.frames, found.batch(numbers).seen.frames)
    assert torch.equal(drawn.target, found.batch(numbers).target)
