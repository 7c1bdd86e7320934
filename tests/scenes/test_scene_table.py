import numpy as np
import pytest

from physpipe.scenes.physics import PhysicsParams, Start, roll
from physpipe.scenes.table import Table, TableParams

HALF, RADIUS, FPS = (0.31, 0.22), 0.03, 30.0
FREE = PhysicsParams(
    gravity_m_s2=9.81, steps_per_frame=400, contact_s=0.004, friction=0, rolling_resistance_m=0, restitution=1
)


def table(restitution: float) -> Table:
    return Table(
        TableParams(kind="table", fixed=True, half_sides_m=HALF, restitution=restitution), np.random.default_rng(0)
    )


def rolled(restitution: float, heading: float, speed: float = 0.8, frames: int = 60) -> np.ndarray:
    """(frames, 2) metres of one ball let go in the middle."""
    start = Start(np.zeros((1, 2)), np.array([heading]), np.array([speed]))
    return roll(table(restitution), start, np.array([RADIUS]), frames, FPS, FREE).xyz_m[:, 0, :2]


def between_cushions(xy: np.ndarray) -> np.ndarray:
    """(N, 2) velocities over the frames in which the ball touches no cushion, m/s."""
    away = (np.abs(xy) < np.array(HALF) - RADIUS - 0.002).all(axis=1)
    velocity = np.diff(xy, axis=0) * FPS
    straight = np.linalg.norm(np.diff(velocity, axis=0), axis=1) < 1e-3
    return velocity[1:][straight & away[1:-1] & away[2:]]


@pytest.mark.parametrize("heading", [0.4, 1.9, 3.5, 5.0])
def test_free_ball_keeps_its_speed_and_its_angle(heading: float) -> None:
    """Without friction and loss, every stretch between cushions has the first one's |vx| and |vy|, to 0.5 %."""
    velocity = np.abs(between_cushions(rolled(1.0, heading)))
    first = 0.8 * np.abs([np.cos(heading), np.sin(heading)])
    assert len(velocity) > 15
    np.testing.assert_allclose(velocity, np.broadcast_to(first, velocity.shape), rtol=0.005, atol=0.002)


def test_cushion_takes_what_its_restitution_says() -> None:
    velocity = between_cushions(rolled(0.7, 0.0))[:, 0]
    after_one = velocity[velocity < 0][0]
    assert after_one == pytest.approx(-0.7 * 0.8, rel=0.05)


@pytest.mark.parametrize("heading", [0.2, 0.7, 2.6, 4.1])
def test_ball_never_leaves(heading: float) -> None:
    """Its edge sinks into a cushion by no more than 2 mm at 2 m/s."""
    xy = rolled(0.9, heading, speed=2.0, frames=120)
    assert (np.abs(xy) < np.array(HALF) - RADIUS + 0.002).all()


def test_levels_and_points_agree() -> None:
    ground = table(1.0)
    for azimuth in np.linspace(0, 6, 13):
        x, y = ground.point(0.8, azimuth)
        assert ground.level(np.array(x), np.array(y)) == pytest.approx(0.8)
        assert np.arctan2(y, x) % (2 * np.pi) == pytest.approx(azimuth)
    assert ground.point(1, 0.0) == pytest.approx((HALF[0], 0.0))


def test_ball_sunk_into_a_cushion_is_not_held() -> None:
    ground, radius = table(1.0), np.array([RADIUS])
    assert ground.holds(np.array([HALF[0] - 0.99 * RADIUS]), np.zeros(1), radius)
    assert not ground.holds(np.array([HALF[0] - 0.4 * RADIUS]), np.zeros(1), radius)
