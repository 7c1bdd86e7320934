"""Flow between two frames."""

from pathlib import Path

import numpy as np
import pytest
from worlds import ball_film

from physpipe.core.params import read
from physpipe.flownet.classical import DisParams, FarnebackParams, Flow, Remembered, classical_flows

PARAMS = Path(__file__).parents[2] / "params.yaml"
H, W = 60, 90


def drawn(frame: np.ndarray, following: np.ndarray) -> np.ndarray:
    """A field that tells the pair's order."""
    return np.full((H, W, 2), 10.0 * frame[0, 0, 0] + following[0, 0, 0], np.float32)


@pytest.mark.parametrize("name", ["dis", "farneback"])
def test_a_whole_pixel_s_shift_is_the_flow(name: str) -> None:
    frame = ball_film(np.array([[[45.0, 30.0]]]), 6.0, seed=3, height=H, width=W)[0]
    flows = classical_flows(
        read("baselines.dis", DisParams, PARAMS), read("baselines.farneback", FarnebackParams, PARAMS)
    )
    field = flows[name](frame, np.roll(frame, (1, 2), axis=(0, 1)))
    assert field.shape == (H, W, 2)
    assert field.dtype == np.float32
    np.testing.assert_allclose(np.median(field, axis=(0, 1)), [2, 1], atol=0.1)  # pixels


def test_a_pair_of_frames_is_asked_for_once() -> None:
    asked = []

    def counted(frame: np.ndarray, following: np.ndarray) -> np.ndarray:
        asked.append((frame[0, 0, 0], following[0, 0, 0]))
        return drawn(frame, following)

    flow: Flow = Remembered(counted)
    frames = np.zeros((2, H, W, 3), np.uint8)
    frames[1] = 1
    for first, second in ((0, 1), (1, 0), (0, 1)):
        np.testing.assert_array_equal(flow(frames[first], frames[second]), drawn(frames[first], frames[second]))
    assert asked == [(0, 1), (1, 0)]
