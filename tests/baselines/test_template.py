"""The template tracker: the best path is the best path, and it goes through trouble that a greedy walk does not."""

from itertools import pairwise, product

import numpy as np
import pytest

from physpipe.baselines.template import Candidates, TemplateParams, TemplateTracker, best_path, candidates
from physpipe.io.annotations import Box

H, W, T = 56, 72, 30
PARAMS = TemplateParams(candidates=6, flat_lab=2, smoothness_per_px2=0.002, lost_score=0.4, lost_switch=1)


def total(path: tuple[int, ...], found: Candidates, params: TemplateParams) -> float:
    """Score of one path, straight from the definition; -1 is lost."""
    score = sum(found.lost[t] if n < 0 else found.score[t, n] for t, n in enumerate(path))
    for t, (a, b) in enumerate(pairwise(path)):
        if a >= 0 and b >= 0:
            score -= params.smoothness_per_px2 * ((found.xy[t, a] - found.xy[t + 1, b]) ** 2).sum()
        elif a != b:
            score -= params.lost_switch
    return score


@pytest.mark.parametrize("seed", range(20))
def test_the_path_is_the_best_of_all_paths(seed: int) -> None:
    random = np.random.default_rng([seed])
    found = Candidates(random.uniform(0, 30, (5, 3, 2)), random.uniform(-0.2, 1, (5, 3)), random.uniform(0, 0.6, 5))
    found.score[2, 1:] = -np.inf  # one peak alone in frame 2
    every = [total(path, found, PARAMS) for path in product(range(-1, 3), repeat=5)]
    assert total(tuple(best_path(found, PARAMS)), found, PARAMS) == pytest.approx(max(every), abs=1e-9)


RED, ORANGE, DUN = [200, 60, 40], [230, 160, 40], [150, 120, 90]


def film(xy: np.ndarray, other: np.ndarray | None = None, left: list = ORANGE, cover: slice = slice(0)) -> np.ndarray:
    """(T, H, W, 3): a red and orange disc at `xy` (T, 2), and an `other` one with another `left` half, on grey.

    During the frames `cover`, something as grey as the ground hides the first disc.
    """
    rows, columns = np.mgrid[:H, :W]
    frames = np.repeat((90 + 0.5 * columns)[None, ..., None], len(xy), axis=0) * np.ones(3)
    discs = [(ORANGE, xy, range(len(xy))[cover])] + ([] if other is None else [(left, other, range(0))])
    for left_half, path, hidden in discs:
        for t in sorted(set(range(len(xy))) - set(hidden)):
            x, y = path[t]
            inside = np.clip(5.5 - np.hypot(columns - x, rows - y), 0, 1)[..., None]  # anti-aliased edge
            right = np.clip(columns - x + 0.5, 0, 1)[..., None]
            colour = right * RED + (1 - right) * left_half
            frames[t] = inside * colour + (1 - inside) * frames[t]
    return np.round(frames).astype(np.uint8)


def box_around(xy: np.ndarray, frame: int = 0) -> Box:
    return Box(frame, xy[0] - 7, xy[1] - 7, 15, 15)


def rolling() -> np.ndarray:
    """(T, 2): a gentle arc through the frame, from a whole pixel."""
    t = np.arange(T)
    return np.stack([12 + 1.6 * t, 14 + 1.1 * t - 0.02 * t**2], axis=1)


def test_a_rolling_disc_is_followed_to_a_tenth_of_a_pixel() -> None:
    xy = rolling()
    found = TemplateTracker(PARAMS, [box_around(xy[0])]).track(film(xy))
    assert np.linalg.norm(found.xy - xy, axis=1).max() < 0.1  # pixels
    assert found.score.min() > 0.95
    assert found.xy.dtype == found.score.dtype == np.float32


def test_the_best_path_survives_an_occluder_where_a_greedy_walk_goes_off() -> None:
    xy, hidden = rolling(), slice(10, 14)
    other = np.tile(xy[12] + [0.0, 12.0], (T, 1))  # a somewhat like disc rests beside the place of hiding
    frames, box = film(xy, other, DUN, hidden), box_around(xy[0])
    seen = np.r_[0:10, 14:T]

    at, greedy = xy[0], []  # from the last place to the nearest tolerable peak
    for places, scores in zip(*candidates(frames, [box], PARAMS, None)[:2], strict=True):
        tolerable = places[scores > PARAMS.lost_score]
        at = tolerable[np.linalg.norm(tolerable - at, axis=1).argmin()]
        greedy.append(at)
    assert np.linalg.norm(np.array(greedy) - xy, axis=1)[-10:].min() > 8  # pixels

    found = TemplateTracker(PARAMS, [box]).track(frames)
    assert np.linalg.norm(found.xy - xy, axis=1)[seen].max() < 0.5


def test_a_hidden_object_is_lost_and_found_again() -> None:
    xy = rolling()
    found = TemplateTracker(PARAMS, [box_around(xy[0])]).track(film(xy, cover=slice(12, 20)))
    lost = np.isnan(found.xy).all(axis=1)
    np.testing.assert_array_equal(np.flatnonzero(lost), np.arange(12, 20))
    assert (found.score[lost] == 0).all()
    assert np.linalg.norm(found.xy[~lost] - xy[~lost], axis=1).max() < 0.2


def test_of_two_like_discs_each_box_keeps_its_own() -> None:
    xy = rolling()
    other = xy + np.array([0, 16])
    frames = film(xy, other)
    for path in (xy, other):
        found = TemplateTracker(PARAMS, [box_around(path[0])]).track(frames)
        assert np.linalg.norm(found.xy - path, axis=1).max() < 0.3


def test_a_box_of_broken_pixels_still_marks_its_own_centre() -> None:
    xy = rolling()
    x, y = xy[5]
    found = TemplateTracker(PARAMS, [Box(5, x - 6.5, y - 7.5, 14, 16)]).track(film(xy))
    np.testing.assert_allclose(found.xy[5], xy[5], atol=1e-5)
    assert np.linalg.norm(found.xy - xy, axis=1).max() < 0.3


def test_nothing_is_found_where_it_is_forbidden() -> None:
    xy = rolling()
    ignore = np.zeros((T, H, W), bool)
    ignore[15:] = True
    found = TemplateTracker(PARAMS, [box_around(xy[0])]).track(film(xy), ignore=ignore)
    np.testing.assert_array_equal(np.isnan(found.xy[:, 0]), np.arange(T) >= 15)


def test_without_a_box_everything_is_lost() -> None:
    assert np.isnan(TemplateTracker(PARAMS, []).track(film(rolling())).xy).all()


def test_brightness_of_the_whole_film_does_not_matter() -> None:
    xy = rolling()
    frames = film(xy)
    drifting = (frames * np.linspace(1, 0.7, T)[:, None, None, None]).round().astype(np.uint8)
    found = TemplateTracker(PARAMS, [box_around(xy[0])]).track(drifting)
    assert np.linalg.norm(found.xy - xy, axis=1).max() < 0.25
