import torch

from physpipe.predictors.layers import (
    FrameUnit,
    Locator,
    Residual,
    bilinear_weights,
    normed_conv,
    offsets_from,
    read_at,
    zero_reader,
)

GRID = (4, 8)  # cells down, across
ASPECT = torch.tensor([2.0, 1.0])  # a frame twice as wide as high: x in [-1, 1], y in [-1/2, 1/2]


def test_weights_at_a_cells_centre_are_that_cell_alone():
    weights = bilinear_weights(torch.tensor([[[-0.875, 0.375]]]), GRID, ASPECT)  # first column, last row
    expected = torch.zeros(1, 1, *GRID)
    expected[0, 0, 3, 0] = 1
    torch.testing.assert_close(weights, expected)


def test_weights_between_cells_share_and_outside_go_to_the_edge():
    places = torch.tensor([[[0.0, 0.0], [9.0, -9.0]]])
    weights = bilinear_weights(places, GRID, ASPECT)
    torch.testing.assert_close(weights[0, 0, 1:3, 3:5], torch.full((2, 2), 0.25))
    assert weights[0, 1, 0, 7] == 1
    torch.testing.assert_close(weights.sum((2, 3)), torch.ones(1, 2))


def test_reading_a_field_that_is_linear_in_x_and_y_is_exact_inside():
    places = torch.tensor([[[0.3, -0.2], [-0.61, 0.11]]])
    x, y = offsets_from(torch.zeros(1, 1, 2), GRID, ASPECT)[0]
    read = read_at(torch.stack([x, 3 * y + 1])[None], bilinear_weights(places, GRID, ASPECT))
    expected = torch.stack([places[..., 0], 3 * places[..., 1] + 1], dim=-1)
    torch.testing.assert_close(read, expected)


def test_offsets_are_all_x_then_all_y_and_vanish_at_the_place():
    places = torch.tensor([[[-0.875, -0.375], [0.125, 0.375]]])
    offsets = offsets_from(places, GRID, ASPECT)
    assert offsets.shape == (1, 4, *GRID)
    assert offsets[0, [0, 2], 0, 0].tolist() == [0, 0]
    assert offsets[0, [1, 3], 3, 4].tolist() == [0, 0]
    torch.testing.assert_close(offsets[0, 0, :, 2], torch.full((4,), 0.5))


def test_convolutions_divide_the_size_and_residuals_keep_it():
    frames = torch.zeros(1, 3, 64, 96)
    assert normed_conv(3, 8, kernel=8, stride=4)(frames).shape == (1, 8, 16, 24)
    state = torch.ones(1, 8, 5, 7)
    layer = Residual(8)
    torch.nn.init.zeros_(layer.second.weight)
    torch.nn.init.zeros_(layer.second.bias)
    torch.testing.assert_close(layer(state, state), state)


def test_the_unit_is_half_of_the_longer_side_from_the_frames_centre():
    unit = FrameUnit.of(torch.zeros(2, 3, 20, 40))
    corners = torch.tensor([[-0.5, -0.5], [39.5, 19.5]])  # outer corners of the corner pixels
    torch.testing.assert_close(unit.from_px(corners), torch.tensor([[-1.0, -0.5], [1.0, 0.5]]))
    torch.testing.assert_close(unit.to_px(unit.from_px(corners)), corners)
    torch.testing.assert_close(unit.aspect, ASPECT)


def test_a_locator_finds_the_cell_that_matches_its_query_and_what_that_cell_points_to():
    locate = Locator(channels=4)
    state = torch.zeros(1, 4, *GRID)
    state[0, 0, 3, 0], state[0, 1, 1, 6] = 9.0, 9.0
    queries = 30 * torch.eye(4)[None, :3]
    expected = torch.tensor([[[-0.875, 0.375], [0.625, -0.125], [0.0, 0.0]]])  # the third matches all cells alike
    torch.testing.assert_close(locate(state, queries, ASPECT), expected)
    with torch.no_grad():
        locate.point.weight[0, 1] = 0.01  # cells like the second point to the right
    expected[0, 1, 0] += 0.09
    expected[0, 2, 0] += 0.09 / 32  # the mean over all cells
    torch.testing.assert_close(locate(state, queries, ASPECT), expected)


def test_a_zero_reader_answers_zero():
    assert zero_reader(5, 7, 3)(torch.randn(2, 5)).tolist() == [[0, 0, 0], [0, 0, 0]]
