"""Drawn pairs: their flow is exact, they are a function of the seed, and nothing leaves its range."""

import cv2
import numpy as np
import pytest
import small_flow
from pydantic import ValidationError

from physpipe.core.determinism import torch_generator
from physpipe.flow_learning.film import Pair, PairParams, as_batch, draw_pairs

SMALL = small_flow.params(1).pairs
LOOK = {
    "surface_grey": [90, 160],
    "tint": 30,
    "mottle": 0.12,
    "mottle_px": 16,
    "contour_contrast": 0.15,
    "rim_brightness": 1.15,
    "table_brightness": 0.55,
    "shadow": 0.5,
}
PARAMS = PairParams.model_validate(
    SMALL.model_dump()
    | {
        "size": 96,
        "balls": [1, 3],
        "radius_px": [4, 7],
        "rgb": [20, 200],
        "step_px": 10,
        "camera_px": 2,
        "exposure": [0, 0.5],
        "shutter_moments": 5,
        "drift": 0.15,
        "noise": [1, 6],
        "hill_m": [0, 0.15],
        "hill_px": 48,
        "look": SMALL.look.model_dump() | LOOK,
    }
)


def clean(**changes: object) -> PairParams:
    """Without what keeps two pictures of one thing from being equal: noise, light, blur, shadows, hard edges."""
    look = PARAMS.look.model_dump() | {"shadow": 0, "rim": 0, "table_brightness": 1, "mottle_px": 16}
    plain = {"noise": [0, 0], "drift": 0, "exposure": [0, 0], "balls": [1, 1], "look": look}
    return PairParams.model_validate(PARAMS.model_dump() | plain | changes)


def warped_back(pair: Pair) -> np.ndarray:
    """(H, W, 3) the second frame looked up where the flow says that the first one's pixels went."""
    rows, columns = np.mgrid[: pair.flow.shape[0], : pair.flow.shape[1]].astype(np.float32)
    x, y = columns + pair.flow[..., 0], rows + pair.flow[..., 1]
    return cv2.remap(pair.frames[1].astype(np.float32), x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def pairs(params: PairParams, count: int, seed: int = 0) -> list[Pair]:
    return draw_pairs(params, count, torch_generator(seed))


def test_the_second_frame_warped_back_is_the_first_inside_balls_and_on_the_ground():
    """Grey levels: 2.5 on average inside balls (interpolated shading), 1 on the ground; unwarped it is ten times as
    much inside the balls."""
    inside, still, ground = [], [], []
    for pair in pairs(clean(), 12):
        if np.linalg.norm(pair.flow[pair.inside][0]) < 2:
            continue  # too little to tell
        core = cv2.erode(pair.inside.astype(np.uint8), np.ones((3, 3))).astype(bool)  # the rim is half ground
        near = cv2.dilate(pair.inside.astype(np.uint8), np.ones((31, 31))).astype(bool)  # the second frame's ball too
        near[:4], near[-4:], near[:, :4], near[:, -4:] = True, True, True, True  # comes from beyond the border
        first = pair.frames[0].astype(np.float32)
        inside.append(np.abs(warped_back(pair) - first)[core].mean())
        still.append(np.abs(pair.frames[1] - first)[core].mean())
        ground.append(np.abs(warped_back(pair) - first)[~near].mean())
    assert len(inside) > 6
    assert np.mean(inside) < 2.5
    assert np.mean(still) > 10 * np.mean(inside)
    assert np.max(ground) < 1


def test_with_noise_and_light_the_residual_is_theirs_alone():
    """Of a still camera's ground: two independent noises, and a gain within the drift."""
    noisy = clean(noise=[5, 5], camera_px=0)
    for pair in pairs(noisy, 4):
        far = ~cv2.dilate(pair.inside.astype(np.uint8), np.ones((31, 31))).astype(bool)
        residual = (warped_back(pair) - pair.frames[0])[far]
        assert np.sqrt(np.mean(residual**2)) == pytest.approx(5 * np.sqrt(2), rel=0.05)
    for pair in pairs(clean(drift=0.2, camera_px=0), 4):
        ratio = pair.frames[1].mean() / pair.frames[0].mean()
        assert abs(ratio - 1) <= 0.2 + 0.01  # rounding, and the ball that moved


def test_flow_is_the_ball_s_way_inside_its_disc_and_one_shift_elsewhere():
    for pair in pairs(PARAMS, 20):
        ground = pair.flow[~pair.inside]
        assert (ground == ground[0]).all()
        assert np.linalg.norm(ground[0]) <= 2
        ways = np.unique(pair.flow[pair.inside], axis=0)
        assert 1 <= len(ways) <= 3
        assert np.linalg.norm(ways, axis=1).max() <= 10


def test_a_ball_s_disc_has_the_area_of_its_radius():
    drawn = pairs(clean(radius_px=[5, 5]), 20)
    assert np.mean([pair.inside.sum() for pair in drawn]) == pytest.approx(np.pi * 25, rel=0.02)


def test_the_same_seed_gives_the_same_pairs_and_another_gives_others():
    once, again, other = pairs(PARAMS, 2), pairs(PARAMS, 2), pairs(PARAMS, 2, seed=1)
    for a, b, c in zip(once, again, other, strict=True):
        for mine, same in zip(a, b, strict=True):
            np.testing.assert_array_equal(mine, same)
        assert not np.array_equal(a.frames, c.frames)


def test_a_batch_holds_the_pairs_in_order():
    drawn = pairs(PARAMS, 3)
    batch = as_batch(drawn)
    assert batch.first.shape == batch.second.shape == (3, 3, 96, 96)
    np.testing.assert_allclose(batch.second[2].permute(1, 2, 0) * 255, drawn[2].frames[1], atol=1e-3)
    np.testing.assert_array_equal(batch.flow[1].permute(1, 2, 0), drawn[1].flow)
    np.testing.assert_array_equal(batch.inside[0], drawn[0].inside)
    assert 0 <= batch.first.min() <= batch.first.max() <= 1


@pytest.mark.parametrize(
    ("change", "reason"),
    [({"balls": [3, 1]}, "no range"), ({"noise": [-1, 2]}, "no range"), ({"step_px": 85}, "does not fit")],
)
def test_what_cannot_be_drawn_is_refused(change, reason):
    with pytest.raises(ValidationError, match=reason):
        PairParams.model_validate(PARAMS.model_dump() | change)
