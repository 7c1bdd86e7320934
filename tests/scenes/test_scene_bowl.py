import numpy as np
import pytest
from pydantic import ValidationError

from physpipe.scenes.bowl import Bowl, BowlParams

PARAMS = BowlParams(kind="bowl", fixed=False, rim_radius_m=(0.2, 0.3), depth_m=(0.15, 0.2), cut=0.7)


@pytest.fixture
def bowl() -> Bowl:
    return Bowl(PARAMS, np.random.default_rng(4))


def test_bottom_is_at_zero_and_rim_at_depth(bowl: Bowl) -> None:
    rim = np.array([bowl.point(1, azimuth) for azimuth in np.linspace(0, 6, 25)]).T
    assert bowl.height(np.zeros(1), np.zeros(1)) == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(bowl.height(*rim), bowl.depth, rtol=1e-9)
    np.testing.assert_allclose(bowl.level(*rim), 1, rtol=1e-9)


def test_height_is_held_outside_the_rim(bowl: Bowl) -> None:
    beyond = np.array([bowl.point(level, 0.7) for level in (1.01, 1.5, 20)]).T
    np.testing.assert_allclose(bowl.height(*beyond), bowl.depth, rtol=1e-9)


@pytest.mark.parametrize("azimuth", [0.0, 1.0, 2.5, 4.0])
def test_slope_is_the_heights_derivative(bowl: Bowl, azimuth: float) -> None:
    x, y = bowl.point(0.6, azimuth)
    step = 1e-6  # metres; central differences err by about step^2
    height, slope_x, slope_y = bowl.height_and_slope(x, y)
    east = bowl.height(np.array([x - step, x + step]), np.array([y, y]))
    south = bowl.height(np.array([x, x]), np.array([y - step, y + step]))
    assert height == pytest.approx(float(bowl.height(np.array(x), np.array(y))), abs=1e-12)
    assert slope_x == pytest.approx((east[1] - east[0]) / 2 / step, abs=1e-6)
    assert slope_y == pytest.approx((south[1] - south[0]) / 2 / step, abs=1e-6)


def test_surface_is_an_ellipsoid(bowl: Bowl) -> None:
    """(u/a)^2 + (v/b)^2 + ((z - c)/c)^2 = 1 holds with the same a, b, c at every point."""
    uv = np.random.default_rng(0).uniform(-0.1, 0.1, (50, 2))
    x, y = np.array([[bowl._cos * u - bowl._sin * v, bowl._sin * u + bowl._cos * v] for u, v in uv]).T
    z, (a, b) = bowl.height(x, y), bowl.rim / PARAMS.cut
    c = bowl.depth / (1 - np.sqrt(1 - PARAMS.cut**2))
    np.testing.assert_allclose((uv[:, 0] / a) ** 2 + (uv[:, 1] / b) ** 2 + (z / c - 1) ** 2, 1, rtol=1e-9)


def test_unordered_range_is_refused() -> None:
    with pytest.raises(ValidationError, match="no range"):
        BowlParams(kind="bowl", fixed=False, rim_radius_m=(0.3, 0.2), depth_m=(0.15, 0.2), cut=0.7)
