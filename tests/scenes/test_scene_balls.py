import numpy as np
import pytest

from physpipe.scenes.balls import Smear, draw_ball, draw_shadow
from physpipe.scenes.look import Light
from physpipe.scenes.world_params import WorldParams

OVERHEAD = Light(np.array([0.0, 0.0, 1.0]))
WIDTH, HEIGHT, RADIUS = 90, 60, 6.0


def smear(xy: list[list[float]], way: list[float]) -> Smear:
    return Smear(np.array(xy), np.tile(way, (len(xy), 1)), 9, (WIDTH, HEIGHT))


def centroid(weight: np.ndarray) -> np.ndarray:
    rows, columns = np.indices(weight.shape)
    return np.array([(columns * weight).sum(), (rows * weight).sum()]) / weight.sum()


@pytest.mark.parametrize("way", [[0.0, 0.0], [3.0, -1.5]])
@pytest.mark.parametrize("xy", [[40.0, 30.0], [40.3, 29.6], [70.5, 12.25]])
def test_ball_lies_where_it_should(world: WorldParams, xy: list[float], way: list[float]) -> None:
    """The middle of what the ball covers is its true centre, to 0.02 px, smeared or not."""
    ball = draw_ball(smear([xy], way), RADIUS, (255, 0, 0), OVERHEAD, world.look)
    cover = np.ones((HEIGHT, WIDTH, 1), np.float32)
    x, y = ball.corner[0]
    size = ball.through.shape[1]
    cover[y : y + size, x : x + size] = ball.through[0]
    np.testing.assert_allclose(centroid(1 - cover[..., 0]), xy, atol=0.02)
    assert (1 - cover).sum() == pytest.approx(np.pi * RADIUS**2, rel=0.01)


def test_smear_lengthens_the_ball_along_its_way(world: WorldParams) -> None:
    sharp, blurred = (
        draw_ball(smear([[40, 30]], way), RADIUS, (255, 0, 0), OVERHEAD, world.look) for way in ([0, 0], [8, 0])
    )
    spread = [(each.through[0, :, :, 0].min(axis=k) < 0.999).sum() for each in (sharp, blurred) for k in (0, 1)]
    assert spread[2] >= spread[0] + 6  # columns
    assert abs(spread[3] - spread[1]) <= 1  # rows


def test_shadow_falls_away_from_the_lamp(world: WorldParams) -> None:
    lamp = Light(np.array([0.6, 0.0, 0.8]))
    shadow = draw_shadow(smear([[40, 30]], [0, 0]), RADIUS, lamp, world.look)
    middle = centroid(1 - shadow.through[0, :, :, 0]) + shadow.corner[0]
    np.testing.assert_allclose(middle, [40 - RADIUS * 0.6 / 0.8, 30], atol=0.05)
    assert 1 - shadow.through.min() == pytest.approx(world.look.shadow, abs=1e-6)


def test_ball_out_of_the_frame_changes_nothing(world: WorldParams) -> None:
    ball = draw_ball(smear([[-50, 30], [40, 200]], [0, 0]), RADIUS, (255, 0, 0), OVERHEAD, world.look)
    picture = np.full((HEIGHT, WIDTH, 3), 7, np.float32)
    for frame in (0, 1):
        ball.paint(picture, frame)
    assert (picture == 7).all()
