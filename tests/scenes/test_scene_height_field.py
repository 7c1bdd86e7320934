import numpy as np
import pytest
from pydantic import ValidationError

from physpipe.scenes.height_field import HeightField, HeightsParams

RIM, RADIUS = 0.05, 0.3
PARAMS = HeightsParams(
    kind="heights",
    fixed=False,
    radius_m=RADIUS,
    rim_m=RIM,
    hills=9,
    hill_width_m=(0.05, 0.09),
    relief_m=(0.02, 0.03),
    tightest_m=0.06,
)
STEEP = PARAMS.model_copy(update={"relief_m": (9.0, 9.0)})


def ground(seed: int, params: HeightsParams = PARAMS) -> HeightField:
    return HeightField(params, np.random.default_rng(seed))


def disc(points: int) -> tuple[np.ndarray, np.ndarray]:
    side = np.linspace(-RADIUS, RADIUS, points)
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    inside = np.hypot(x, y) < RADIUS
    return x[inside], y[inside]


@pytest.mark.parametrize("seed", range(4))
def test_slope_is_the_heights_derivative(seed: int) -> None:
    field, step = ground(seed), 1e-6  # metres; central differences err by about step^2
    for azimuth in (0.3, 2.0, 4.5):
        x, y = field.point(0.7, azimuth)
        height, slope_x, slope_y = field.height_and_slope(x, y)
        east = field.height(np.array([x - step, x + step]), np.array([y, y]))
        south = field.height(np.array([x, x]), np.array([y - step, y + step]))
        assert height == pytest.approx(float(field.height(np.array(x), np.array(y))), abs=1e-12)
        assert slope_x == pytest.approx((east[1] - east[0]) / 2 / step, abs=1e-6)
        assert slope_y == pytest.approx((south[1] - south[0]) / 2 / step, abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_lowest_point_has_no_height_and_hills_their_relief(seed: int) -> None:
    """On a grid three times as fine as its own, to 1 % of the relief."""
    x, y = disc(193)
    height = ground(seed).height(x, y)
    hills = height - RIM * (np.hypot(x, y) / RADIUS) ** 4
    assert height.min() == pytest.approx(0, abs=0.01 * PARAMS.relief_m[0])
    assert 0.99 * PARAMS.relief_m[0] < np.ptp(hills) < 1.01 * PARAMS.relief_m[1]


@pytest.mark.parametrize("seed", range(4))
def test_nothing_bends_tighter_than_allowed(seed: int) -> None:
    """Second differences along 12 directions stay below 1 / tightest, and steep hills come to within 10 % of it."""
    field, step = ground(seed, STEEP), 1e-4
    x, y = (0.98 * axis for axis in disc(101))
    worst = 0.0
    for angle in np.arange(12) * np.pi / 12:
        dx, dy = step * np.cos(angle), step * np.sin(angle)
        second = (field.height(x + dx, y + dy) + field.height(x - dx, y - dy) - 2 * field.height(x, y)) / step**2
        worst = max(worst, np.abs(second).max())
    assert 0.9 / STEEP.tightest_m < worst < 1.02 / STEEP.tightest_m


def test_border_is_a_circle_beyond_which_height_is_held() -> None:
    field = ground(5)
    rim = np.array([field.point(1, azimuth) for azimuth in np.linspace(0, 6, 25)]).T
    np.testing.assert_allclose(field.level(*rim), 1, rtol=1e-12)
    np.testing.assert_allclose(field.height(*(3 * rim)), field.height(*rim), atol=1e-12)


def test_every_draw_is_another_terrain() -> None:
    x, y = disc(21)
    assert np.abs(ground(0).height(x, y) - ground(1).height(x, y)).max() > 0.2 * PARAMS.relief_m[0]
    np.testing.assert_array_equal(ground(3).height(x, y), ground(3).height(x, y))


@pytest.mark.parametrize("change", [{"relief_m": (0.3, 0.2)}, {"hill_width_m": (0.0, 0.1)}, {"rim_m": 0.2}])
def test_impossible_ground_is_refused(change: dict) -> None:
    with pytest.raises(ValidationError, match=r"no range|rim alone bends"):
        HeightsParams.model_validate(PARAMS.model_dump() | change)
