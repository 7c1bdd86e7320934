"""From track tables to figures."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from physpipe.core.ball import BallParams
from physpipe.core.geometry import Geometry
from physpipe.io import results, tracks
from physpipe.io.clips import Clip, ClipSet, save
from physpipe.metrics.trackers import OtherMotionParams
from physpipe.scoring.trackers import EvaluateTrackersParams, score_trackers

H, W, T = 40, 64, 16
BALL = BallParams(ball_radius_px=4)
PARAMS = EvaluateTrackersParams(
    off_track_radii=3,
    off_track_frames=10,
    swap_frames=5,
    bootstrap_resamples=200,
    other_motion=OtherMotionParams(threshold_grey=25, narrowest_px=5, share=0.01, disc_radii=2),
)
HAND = range(4, 8)


def paths() -> np.ndarray:
    """(T, 2, 2) pixels, never nearer than 18 px."""
    t = np.arange(T)
    return np.stack([np.stack([8 + 3.0 * t, 8 + 0.5 * t], 1), np.stack([55 - 3.0 * t, 30 + 0.1 * t], 1)], axis=1)


@pytest.fixture
def clips(tmp_path: Path) -> ClipSet:
    """Test clips a and b, training clip c; a hand lies in the corner of b during HAND."""
    times, numbers, status = np.arange(T) / 80, np.arange(T, dtype=np.int32), np.array(["ok"] * T)
    made = []
    for name, split in (("a", "test"), ("b", "test"), ("c", "train")):
        frames = np.full((T, H, W, 3), 150, np.uint8)
        frames[HAND.start : HAND.stop if name == "b" else HAND.start, :12, -12:] = 30
        made.append(Clip(name, split, "film.mp4", Geometry(0, 0, W, H, W, H), frames, times, numbers, times, status))
    save(tmp_path / "clips", made)
    return ClipSet(tmp_path / "clips")


def table(**positions: np.ndarray) -> pd.DataFrame:
    """A track table from (T, K, 2) positions by clip."""
    parts = [tracks.rows(name, np.arange(T) / 80, xy, np.ones(xy.shape[:2])) for name, xy in positions.items()]
    return pd.concat(parts, ignore_index=True)


def score(clips: ClipSet, truth: pd.DataFrame, **tables: pd.DataFrame) -> tuple[dict, pd.DataFrame]:
    return score_trackers(clips, truth, tables, {"ours": {"locked": True, "score": 0.2}}, PARAMS, BALL)


def test_a_tracker_fed_the_truth_scores_exactly_zero(clips: ClipSet) -> None:
    truth = table(a=paths(), b=paths(), c=paths())
    figures, errors = score(clips, truth, ours=truth)
    ours = figures["ours"]
    for key in ("mean_px", "median_px", "p99_px", "var_px2", "bias_px", "jitter_px", "lost", "off_track", "swaps"):
        assert ours[key] == 0, key
    assert (ours["mean_px_low"], ours["mean_px_high"], ours["delta_avg"]) == (0, 0, 1)
    assert (ours["clips"], ours["frames"], ours["locked"]) == (2, 4 * T, True)  # the training clip is not scored
    assert (errors["error_px"] == 0).all()
    assert errors.columns.tolist() == ["tracker", "clip", "object", "frame", "error_px"]
    assert len(errors) == 4 * T


def test_a_constant_offset_is_all_bias_and_objects_may_be_numbered_otherwise(clips: ClipSet) -> None:
    offset = np.array([3, 4])
    truth = table(a=paths(), b=paths())
    shifted = table(a=paths() + offset, b=paths()[:, ::-1] + offset)
    ours = score(clips, truth, ours=shifted)[0]["ours"]
    assert ours["mean_px"] == pytest.approx(5, abs=1e-5)  # float32 positions
    assert ours["bias_px"] == pytest.approx(5, abs=1e-5)
    assert ours["jitter_px"] == pytest.approx(0, abs=1e-5)
    assert (ours["swaps"], ours["off_track"]) == (0, 0)


def test_swaps_and_leaving_the_track_are_counted_by_clip(clips: ClipSet) -> None:
    exchanged, left = paths(), paths()
    exchanged[2:8] = exchanged[2:8, ::-1]
    left[5:, 1] += [0, 12.5]  # radii: 3 are 12 px
    figures, _ = score(clips, table(a=paths(), b=paths()), ours=table(a=exchanged, b=left))
    assert figures["ours"]["swaps"] == 0.5
    assert figures["ours"]["off_track"] == 0.25  # one of four objects


def test_lost_frames_count_beside_the_errors_of_found_ones(clips: ClipSet) -> None:
    holes = paths() + np.array([0, 2])
    holes[4:8, 0] = np.nan
    figures, errors = score(clips, table(a=paths(), b=paths()), ours=table(a=holes))
    assert figures["ours"]["mean_px"] == pytest.approx(2, abs=1e-5)
    assert figures["ours"]["lost"] == (4 + 2 * T) / (4 * T)  # clip b has no track at all
    assert errors["error_px"].isna().sum() == 4 + 2 * T
    assert figures["ours"]["off_track"] == 0.5


def test_frames_with_a_hand_are_counted_apart(clips: ClipSet) -> None:
    found = paths()
    found[HAND] += [6, 0]
    figures, _ = score(clips, table(b=paths()), ours=table(b=found))
    ours = figures["ours"]
    assert ours["disturbed"] == len(HAND) / T
    assert ours["mean_px_disturbed"] == pytest.approx(6, abs=1e-5)
    assert (ours["mean_px_alone"], ours["p99_px_alone"]) == (0, 0)
    assert ours["mean_px"] == pytest.approx(6 * len(HAND) / T, abs=1e-5)


def test_the_users_tags_overrule_what_seems_to_move(clips: ClipSet) -> None:
    truth = table(a=paths(), b=paths()).assign(tag="")
    truth.loc[(truth["clip"] == "a") & (truth["frame"] < 2), "tag"] = "hand"
    ours = score(clips, truth, ours=truth)[0]["ours"]
    assert ours["disturbed"] == 2 / (2 * T)


def test_without_truth_every_figure_is_null(clips: ClipSet, tmp_path: Path) -> None:
    found = table(a=paths(), b=paths())
    figures, errors = score(clips, tracks.empty(), ours=found, other=found)
    assert errors.empty
    results.save_json(tmp_path / "figures.json", figures)
    read = results.load_json(tmp_path / "figures.json")
    full = score(clips, found, ours=found)[0]["ours"]
    for name, locked in (("ours", True), ("other", None)):
        assert read[name].keys() == full.keys()
        assert read[name].pop("clips") == read[name].pop("frames") == 0
        assert read[name].pop("locked") is locked
        assert read[name].pop("score") == (0.2 if locked else None)
        assert set(read[name].values()) == {None}


def test_one_object_has_no_swaps_to_speak_of(clips: ClipSet) -> None:
    single = table(a=paths()[:, :1])
    assert np.isnan(score(clips, single, ours=single)[0]["ours"]["swaps"])


def test_figures_of_identity_are_null_for_one_object(clips: ClipSet) -> None:
    single = table(a=paths()[:, :1])
    ours = score(clips, single, ours=single)[0]["ours"]
    for key in ("hota", "idf1", "id_switches", "idf1_unflagged", "flagged"):
        assert np.isnan(ours[key]), key


def test_identity_counts_a_track_too_many_that_errors_pass_over(clips: ClipSet) -> None:
    truth = table(a=paths(), b=paths())
    spare = np.concatenate([np.full((T, 1, 2), [60.0, 2.0]), paths()], axis=1)
    ours = score(clips, truth, ours=table(a=spare, b=paths()))[0]["ours"]
    assert (ours["mean_px"], ours["lost"], ours["swaps"]) == (0, 0, 0)
    assert ours["idf1"] == pytest.approx(2 * 4 * T / (4 * T + 5 * T))
    missing = score(clips, truth, ours=table(a=paths()))[0]["ours"]
    assert (missing["mean_px"], missing["lost"]) == (0, 0.5)
    assert missing["idf1"] == pytest.approx(2 * 2 * T / (4 * T + 2 * T))


def test_a_swap_that_the_tracker_called_doubtful_is_forgiven_outside_flagged_spans(clips: ClipSet) -> None:
    exchanged = paths()
    exchanged[8:] = exchanged[8:, ::-1]
    status = np.full((T, 2), "tracked", object)
    status[8, 1] = "ambiguous"
    doubted = tracks.rows("a", np.arange(T) / 80, exchanged, np.ones((T, 2)), status)
    ours = score(clips, table(a=paths()), ours=doubted)[0]["ours"]
    assert (ours["idf1"], ours["id_switches"], ours["idf1_unflagged"]) == (0.5, 2, 1)
    assert ours["flagged"] == 1 / T
