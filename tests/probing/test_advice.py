"""Advice that ingest can follow: a crop that holds all motion, clips for every split, one rate."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from physpipe.ingest.dataset import clip_name
from physpipe.ingest.splits import SplitParams, drawn
from physpipe.io.clips import SPLITS
from physpipe.probing.advice import Advice, _cut, advise, horizon
from physpipe.probing.crop import geometry, likely_crop
from physpipe.probing.findings import Finding, look
from physpipe.probing.hurts import hurts, hurts_of_set

SHARES = SplitParams(valid=0.2, test=0.35)
SIZE = 32


@pytest.fixture
def finding(roll: Callable[..., Path]) -> Finding:
    path = roll()
    return look(path, path.parent, None)


def changed(finding: Finding, **clock: object) -> Finding:
    """The same with another clock."""
    return replace(finding, film=replace(finding.film, clock=replace(finding.film.clock, **clock)))


def test_the_crop_is_a_square_in_the_frame_around_all_that_moves(finding: Finding) -> None:
    crop = likely_crop([finding])
    assert crop is not None
    left, top, right, bottom = finding.box
    assert crop.width == crop.height < 60
    assert 0 <= crop.left <= left
    assert right <= crop.left + crop.width <= 90
    assert 0 <= crop.top <= top
    assert bottom <= crop.top + crop.height <= 60
    place = geometry(finding, crop, SIZE)
    assert (place.crop_width, place.width) == (crop.width, SIZE)


def test_frames_of_several_sizes_get_no_common_crop(finding: Finding) -> None:
    other = replace(finding, film=replace(finding.film, width=100))
    assert likely_crop([finding, other]) is None
    assert "several sizes" in hurts_of_set([finding, other], advise([finding, other], SIZE, SHARES, None))[0]


def test_motion_all_over_the_frame_needs_no_crop(roll: Callable[..., Path]) -> None:
    angle = 2 * np.pi * np.arange(120)[:, None] / 60
    path = roll(np.stack([45 + 22 * np.cos(angle), 30 + 22 * np.sin(angle)], axis=-1))
    assert likely_crop([look(path, path.parent, None)]) is None


def test_numbers_go_with_the_film(finding: Finding) -> None:
    advice = advise([finding], SIZE, SHARES, None)
    assert (advice.fps, advice.source_fps, advice.objects) == (None, None, 1)
    assert advice.crop is not None
    assert advice.radius_px == pytest.approx(5 * SIZE / advice.crop.width, rel=0.2)
    assert advice.max_gap_s == pytest.approx(5 / 100, abs=0.005)
    changes = advice.changes()
    assert changes["ingest.clip_frames"] == advice.cut.frames
    assert changes["ingest.min_frames"] <= changes["ingest.clip_frames"]
    assert changes["predict.horizon"] < changes["ingest.clip_frames"]


@pytest.mark.parametrize(
    "lengths", [{"a": 439, "b": 474}, {"test1": 258, "test2": 218}, {"ball": 79}, {"film/one": 200}]
)
def test_every_split_has_clips_and_they_are_as_long_as_can_be(lengths: dict[str, int]) -> None:
    frames, count, empty = _cut(lengths, SHARES)
    names = [
        clip_name(stem, part)
        for stem, length in lengths.items()
        for part in range(length // frames + (length % frames >= max(5, frames // 2)))
    ]
    assert (len(names), {drawn(name, SHARES) for name in names}) == (count, {"train", "valid", "test"})
    assert empty == ()


def test_a_split_without_clips_is_warned_of(finding: Finding) -> None:
    assert _cut({"a": 9}, SHARES)[1:] == (1, tuple(each for each in SPLITS if each != drawn("a_00", SHARES)))
    advice = advise([changed(finding, frames=12)], SIZE, SHARES, None)
    assert advice.cut.empty
    assert "no clip for " in hurts_of_set([finding], advice)[0]
    assert advise([changed(finding, frames=12)], SIZE, None, None).cut.empty == ()  # a split file decides


@pytest.mark.parametrize(("frames", "warned_of"), [(8, True), (11, True), (12, False), (60, False)])
def test_clips_too_short_to_forecast_in_are_warned_of(finding: Finding, frames: int, warned_of: bool) -> None:
    advice = advise([finding], SIZE, SHARES, None)
    said = hurts_of_set([finding], replace(advice, cut=advice.cut._replace(frames=frames)))
    assert any(f"clips of {frames} frames only, forecast to frame" in each for each in said) == warned_of


def test_horizons_fit_their_clips() -> None:
    assert [horizon(frames) for frames in (84, 60, 40, 20, 12, 8)] == [20, 14, 10, 10, 10, 6]


def test_rates_that_differ_or_waver_are_brought_to_one(finding: Finding) -> None:
    slow = changed(finding, measured_fps=25.0)
    assert advise([finding, slow], SIZE, SHARES, None).fps == 25
    assert advise([changed(finding, uneven=0.4)], SIZE, SHARES, None).fps == 100
    assert advise([finding, slow], SIZE, SHARES, 240.0).fps is None
    assert advise([finding, slow], SIZE, SHARES, 240.0).source_fps == 240


def test_crawling_film_is_thinned(finding: Finding) -> None:
    assert finding.movers is not None
    crawling = replace(finding, movers=finding.movers._replace(speeds=np.full(9, 0.1)))
    advice = advise([crawling], 40, SHARES, None)  # clip pixels, about those of the film
    assert advice.fps is not None
    assert 0.5 < 0.1 * geometry(finding, advice.crop, 40).scale[0] * 100 / advice.fps <= 1.0


def test_slow_motion_that_says_so_gets_its_true_rate(finding: Finding) -> None:
    assert advise([changed(finding, tagged_fps=240.0)], SIZE, SHARES, None).source_fps == 240


def test_recordings_that_disagree_leave_the_number_open(finding: Finding) -> None:
    assert finding.movers is not None
    two = replace(finding, movers=finding.movers._replace(number=2))
    advice = advise([finding, two], SIZE, SHARES, None)
    assert advice.objects is None
    assert any("how many objects" in each for each in hurts_of_set([finding, two], advice))


def warned(finding: Finding, size: int = SIZE) -> str:
    return "\n".join(hurts(finding, geometry(finding, likely_crop([finding]), size)))


def test_good_film_is_not_warned_of(finding: Finding) -> None:
    assert warned(finding) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"jump_px": 4.0}, "the camera moves"),
        ({"flicker": 0.1}, "flickers by 10%"),
        ({"drift": 0.5}, "brightness changes by 50%"),
        ({"blur_px": 9.0}, "blurred by 9.0 px"),
        ({"repeated": 0.5}, "50% of the frames repeat"),
        ({"movers": None}, "nothing moves"),
    ],
)
def test_what_hurts_is_named_with_its_size(finding: Finding, change: dict[str, object], said: str) -> None:
    assert said in warned(replace(finding, **change))


def test_what_hurts_the_objects_is_named(finding: Finding) -> None:
    assert finding.movers is not None
    assert "small" in warned(finding, 12)
    assert "large" in warned(finding, 256)
    fast = replace(finding, movers=finding.movers._replace(speeds=np.full(9, 30.0)))
    assert "30 px a frame, 3." in warned(fast)
    wide = replace(finding, movers=finding.movers._replace(box=(0.0, 10.0, 90.0, 40.0)))
    assert "leave the clips' square" in warned(wide)
    assert "count them" in warned(replace(finding, movers=finding.movers._replace(number=None)))


def test_little_film_is_warned_of(finding: Finding) -> None:
    short = changed(finding, frames=30)
    assert "only 30 frames" in warned(short)
    advice = advise([short], SIZE, SHARES, None)
    assert isinstance(advice, Advice)
    assert "too little to learn from" in hurts_of_set([short], advice)[-1]
