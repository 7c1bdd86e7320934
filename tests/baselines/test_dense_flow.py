"""Following a flow field, a known one and those of OpenCV."""

import numpy as np
import pytest
from worlds import ball_film

from physpipe.baselines.dense_flow import FlowBlob, FlowParams, FlowSimple
from physpipe.baselines.zoo import BaselineParams, known_flows

RADIUS_PX = 6.0
H, W = 60, 90
SLOW = np.stack([25 + 1.2 * np.arange(20), 30 + 0.7 * np.arange(20)], axis=1)
STEP = np.array([1.5, 0.5])


def at(t: int) -> np.ndarray:
    return np.array([20.0, 25.0]) + t * STEP


def exact_flow(frame: np.ndarray, following: np.ndarray) -> np.ndarray:
    """What a disc at `at(t)` does over a ground that shakes by (0.3, -0.2); t is the first pixel's value."""
    rows, columns = np.mgrid[:H, :W]
    x, y = at(int(frame[0, 0, 0]))
    disc = np.hypot(columns - x, rows - y) <= RADIUS_PX
    return np.where(disc[..., None], STEP, [0.3, -0.2]).astype(np.float32)


@pytest.fixture
def numbered() -> np.ndarray:
    """(T, H, W, 3) frames that hold nothing but their number."""
    return np.broadcast_to(np.arange(16, dtype=np.uint8)[:, None, None, None], (16, H, W, 3))


@pytest.fixture
def flow(params: BaselineParams) -> FlowParams:
    return params.flow


def test_the_flow_at_the_object_moves_it(numbered, flow: FlowParams) -> None:
    found = FlowSimple(exact_flow, flow, RADIUS_PX).track(numbered, at(0) + 1)
    np.testing.assert_allclose(found.xy, [at(t) + 1 for t in range(16)], atol=1e-3)  # pixels: 2a keeps an offset
    assert (found.score == 1).all()


def test_the_blob_s_centre_corrects_what_the_flow_carries_on(numbered, flow: FlowParams) -> None:
    found = FlowBlob(exact_flow, flow, RADIUS_PX).track(numbered, at(0) + np.array([2, 1]))
    offset = np.linalg.norm(found.xy - [at(t) for t in range(16)], axis=1)
    assert offset[0] == pytest.approx(5**0.5)
    assert offset[3:].max() < 0.2  # pixels: the disc's pixels are whole ones


def test_without_a_blob_it_is_the_simple_tracker(numbered, flow: FlowParams) -> None:
    calm = flow.model_copy(update={"blob_px": 5.0})
    blob, simple = (kind(exact_flow, calm, RADIUS_PX).track(numbered, at(0)) for kind in (FlowBlob, FlowSimple))
    np.testing.assert_array_equal(blob.xy, simple.xy)


@pytest.mark.parametrize("kind", [FlowSimple, FlowBlob])
def test_an_object_carried_out_of_the_frame_is_lost(kind, flow: FlowParams) -> None:
    def leftwards(frame: np.ndarray, following: np.ndarray) -> np.ndarray:
        return np.broadcast_to(np.float32([-4, 0]), (H, W, 2))

    found = kind(leftwards, flow, RADIUS_PX).track(np.zeros((9, H, W, 3), np.uint8), np.array([10.0, 30.0]))
    np.testing.assert_array_equal(found.xy[:4, 0], [10, 6, 2, -2])
    assert np.isnan(found.xy[5:]).all()
    assert (found.score[5:] == 0).all()


def test_ignored_pixels_do_not_move_it(numbered, flow: FlowParams) -> None:
    ignore = np.zeros(numbered.shape[:3], bool)
    ignore[4] = True
    found = FlowSimple(exact_flow, flow, RADIUS_PX).track(numbered, at(0), ignore)
    assert np.flatnonzero(np.isnan(found.xy[:, 0])).tolist() == [5]


@pytest.mark.parametrize("name", ["dis", "farneback"])
@pytest.mark.parametrize("kind", [FlowSimple, FlowBlob])
def test_slow_motion_is_followed(name: str, kind, params: BaselineParams) -> None:
    frames = ball_film(SLOW[:, None], RADIUS_PX, seed=2, height=H, width=W)
    found = kind(known_flows(params)[name], params.flow, RADIUS_PX).track(frames, SLOW[0])
    limit_px = 0.7 if kind is FlowSimple else 2.0
    assert np.linalg.norm(found.xy - SLOW, axis=1).max() < limit_px
