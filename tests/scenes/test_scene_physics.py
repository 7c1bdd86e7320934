import numpy as np
import pytest
from scipy.integrate import solve_ivp

from physpipe.scenes.bowl import Bowl, BowlParams
from physpipe.scenes.physics import DENSITY, LeftTerrainError, PhysicsParams, Start, Trajectory, roll

RADIUS, FPS, G = 0.025, 240.0, 9.81
BOWL = BowlParams(kind="bowl", fixed=False, rim_radius_m=(0.25, 0.31), depth_m=(0.2, 0.3), cut=0.75)
LOSSLESS = PhysicsParams(
    gravity_m_s2=G, steps_per_frame=8, contact_s=0.006, friction=0, rolling_resistance_m=0, restitution=1
)


def rolled(physics: PhysicsParams, seed: int, count: int = 1, frames: int = 252) -> tuple[Bowl, Trajectory]:
    """Balls from about half-way up, heading anywhere, for one clip."""
    rng = np.random.default_rng(seed)
    bowl = Bowl(BOWL, rng)
    azimuth = rng.uniform(0, 6) + np.arange(count) * 2 * np.pi / count
    foot = np.array([bowl.point(0.6, angle) for angle in azimuth])
    start = Start(foot, rng.uniform(0, 6, count), np.full(count, 0.6))
    return bowl, roll(bowl, start, np.full(count, RADIUS), frames, FPS, physics)


def mass() -> float:
    return DENSITY * 4 / 3 * np.pi * RADIUS**3


def drift(trajectory: Trajectory) -> np.ndarray:
    """Relative change of energy, which is counted from a ball at rest at the bottom."""
    energy = trajectory.energy_j - trajectory.xyz_m.shape[1] * mass() * G * RADIUS
    return energy / energy[0] - 1


@pytest.mark.parametrize("seed", range(6))
def test_energy_without_friction_drifts_less_than_one_percent(seed: int) -> None:
    assert np.abs(drift(rolled(LOSSLESS, seed)[1])).max() < 0.01


def test_energy_drift_shrinks_with_the_step() -> None:
    coarse, fine = (LOSSLESS.model_copy(update={"steps_per_frame": steps}) for steps in (4, 16))
    worst = [max(np.abs(drift(rolled(each, seed)[1])).max() for seed in range(3)) for each in (coarse, fine)]
    assert worst[1] < worst[0] / 2


def test_rolling_resistance_takes_energy() -> None:
    rough = LOSSLESS.model_copy(update={"friction": 0.5, "rolling_resistance_m": 0.0005})
    assert -0.9 < drift(rolled(rough, 1)[1])[-1] < -0.05


def test_ball_stays_on_the_surface() -> None:
    """The centre is one radius from the nearest of many points of the bowl, to 0.2 mm."""
    bowl, trajectory = rolled(LOSSLESS, 2)
    side = np.linspace(-0.31, 0.31, 400)
    x, y = (grid.ravel() for grid in np.meshgrid(side, side))
    inside = bowl.level(x, y) < 1
    surface = np.stack([x, y, bowl.height(x, y)], axis=1)[inside]
    centres = trajectory.xyz_m[::20, 0]
    gap = np.linalg.norm(centres[:, None] - surface, axis=2).min(axis=1)
    np.testing.assert_allclose(gap, RADIUS, atol=2e-4)


@pytest.mark.parametrize(("friction", "inertia"), [(0.0, 1.0), (0.8, 7 / 5)])
def test_small_swing_has_the_pendulums_period(friction: float, inertia: float) -> None:
    """A ball that rolls without slipping swings as a pendulum with 7/5 of its mass to move (1 when it slides)."""
    bowl = Bowl(
        BowlParams(kind="bowl", fixed=False, rim_radius_m=(0.3, 0.3), depth_m=(0.1, 0.1), cut=0.75),
        np.random.default_rng(0),
    )
    start = Start(np.array([bowl.point(0.05, 0.3)]), np.zeros(1), np.zeros(1))
    physics = LOSSLESS.model_copy(update={"friction": friction})
    trajectory = roll(bowl, start, np.array([RADIUS]), 500, FPS, physics)
    bend = bowl._a2 / bowl._c - RADIUS  # metres, of the centre's path
    expected = 2 * np.pi * np.sqrt(inertia * bend / G)
    x = trajectory.xyz_m[:, 0, 0]
    crossing = np.flatnonzero(np.diff(np.sign(x)))
    period = 2 * (crossing[-1] - crossing[0]) / (len(crossing) - 1) / FPS
    assert period == pytest.approx(expected, rel=0.02)


def test_spin_about_the_normal_makes_a_rolling_ball_swerve() -> None:
    """Rolling without slipping (Routh): v' = 5/7 g + 2/7 s n x n', s' = -v . (n x n'), s the spin times the radius."""
    steep = BOWL.model_copy(update={"rim_radius_m": (0.36, 0.47), "depth_m": (0.7, 0.7), "cut": 0.35})
    bowl = Bowl(steep, np.random.default_rng(0))
    start = Start(np.array([bowl.point(0.7, 1.2)]), np.array([3.34]), np.array([1.8]))
    rough = LOSSLESS.model_copy(update={"friction": 0.8, "steps_per_frame": 80})
    trajectory = roll(bowl, start, np.array([RADIUS]), 72, FPS, rough)
    off = [np.abs(rolling(bowl, start, 72, spins) - trajectory.xyz_m[:, 0]).max() for spins in (True, False)]
    assert off[0] < 0.003  # m
    assert off[1] > 0.03


def rolling(bowl: Bowl, start: Start, frames: int, spins: bool) -> np.ndarray:
    """(F, 3) m, the centres of a ball of RADIUS."""

    def normal(x: float, y: float) -> np.ndarray:
        _, slope_x, slope_y = bowl.height_and_slope(x, y)
        return np.array([-slope_x, -slope_y, 1]) / np.sqrt(1 + slope_x**2 + slope_y**2)

    def rates(_time: float, state: np.ndarray) -> np.ndarray:
        (x, y), velocity, spin = state[:2], state[2:5], state[5]
        n, step = normal(x, y), 1e-5  # m
        bends = np.stack([normal(x + step, y) - normal(x - step, y), normal(x, y + step) - normal(x, y - step)], 1)
        bends /= 2 * step
        foot = np.linalg.solve(np.eye(2) + RADIUS * bends[:2], velocity[:2])  # the centre is RADIUS * n above it
        turning = bends @ foot
        pull = np.array([0, 0, -G])
        along = 5 / 7 * (pull - n * (n @ pull)) + spins * 2 / 7 * spin * np.cross(n, turning)
        return np.concatenate([foot, along - n * (velocity @ turning), [-velocity @ np.cross(n, turning)]])

    foot, heading = start.foot_m[0], start.heading[0]
    _, *slope = bowl.height_and_slope(*foot)
    ahead = np.array([np.cos(heading), np.sin(heading), slope @ np.array([np.cos(heading), np.sin(heading)])])
    velocity = start.speed_m_s[0] * ahead / np.linalg.norm(ahead)
    times = np.arange(frames) / FPS
    feet = solve_ivp(rates, times[[0, -1]], [*foot, *velocity, 0], t_eval=times, rtol=1e-7, atol=1e-8).y[:2].T
    return np.array([[x, y, bowl.height_and_slope(x, y)[0]] + RADIUS * normal(x, y) for x, y in feet])


def collide(restitution: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocities before and after a central collision on level ground, weightless so that nothing else acts."""
    bowl = Bowl(
        BowlParams(kind="bowl", fixed=False, rim_radius_m=(9, 9), depth_m=(1e-6, 1e-6), cut=0.1),
        np.random.default_rng(0),
    )
    start = Start(np.array([[-0.1, 0.0], [0.1, 0.0]]), np.array([0.0, 0.0]), np.array([0.5, 0.0]))
    physics = LOSSLESS.model_copy(update={"restitution": restitution, "gravity_m_s2": 0, "steps_per_frame": 32})
    velocity = np.diff(roll(bowl, start, np.full(2, RADIUS), 200, FPS, physics).xyz_m[..., 0], axis=0) * FPS
    return velocity[0], velocity[-1]


@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_collision_keeps_momentum_and_parts_by_restitution(restitution: float) -> None:
    before, after = collide(restitution)
    assert after.sum() == pytest.approx(before.sum(), rel=1e-3)
    assert (after[1] - after[0]) / (before[0] - before[1]) == pytest.approx(restitution, abs=0.05)


def test_balls_of_two_sizes_keep_their_momentum() -> None:
    """A heavy ball that hits a light one from behind, masses as the cubes of the radii, both on level ground."""
    level = BowlParams(kind="bowl", fixed=False, rim_radius_m=(9, 9), depth_m=(1e-6, 1e-6), cut=0.1)
    start = Start(np.array([[-0.1, 0.0], [0.1, 0.0]]), np.zeros(2), np.array([0.5, 0.0]))
    physics = LOSSLESS.model_copy(update={"gravity_m_s2": 0, "steps_per_frame": 32})
    radius = np.array([0.04, 0.02])
    xyz = roll(Bowl(level, np.random.default_rng(0)), start, radius, 100, FPS, physics).xyz_m
    before, after = (np.diff(xyz[..., 0], axis=0)[k] * FPS for k in (0, -1))
    assert radius**3 @ after == pytest.approx(radius**3 @ before, rel=1e-3)
    assert after[1] > after[0] > 0.25


def test_ball_over_the_rim_is_told() -> None:
    bowl = Bowl(BOWL, np.random.default_rng(0))
    start = Start(np.array([bowl.point(0.8, 0.0)]), np.zeros(1), np.array([9.0]))
    with pytest.raises(LeftTerrainError):
        roll(bowl, start, np.array([RADIUS]), 252, FPS, LOSSLESS)
