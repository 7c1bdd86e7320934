"""Facts about mirrors and quarter turns."""

import pytest
import torch

from physpipe.tracknet.turns import turned, turned_along, turned_back


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_turning_back_undoes_turning_on_a_frame_that_is_not_square(turns, mirrored):
    frames = torch.zeros(1, 3, 5, 8)
    frames[0, :, 1, 6] = 1  # x = 6, y = 1
    moved = turned(frames, turns, mirrored)
    row, column = divmod(int(moved[0, 0].flatten().argmax()), moved.shape[-1])
    seen = torch.tensor([[float(column), float(row)]])
    assert turned_along(torch.tensor([[6.0, 1.0]]), turns, mirrored, height=5, width=8).tolist() == seen.tolist()
    assert turned_back(seen, turns, mirrored, height=5, width=8).tolist() == [[6.0, 1.0]]
