"""Facts about the energy of paths on a terrain, with MuJoCo's own as the oracle."""

from dataclasses import replace

import numpy as np
import pytest
from simulated import of_the_project

from physpipe.scenes.energy import energy_j, lifted
from physpipe.scenes.physics import DENSITY
from physpipe.scenes.world_params import WorldParams
from physpipe.scenes.worlds import Chances, World, draw_world, track

APART = 3
"""Source frames from one moment to the next, as in a clip."""


def drawn(params: WorldParams, name: str, number: int) -> World:
    """From the release on."""
    world = draw_world(params, Chances.of(name, number))
    return replace(world, xyz_m=world.xyz_m[-params.moving_frames :])


def energies(params: WorldParams, name: str, number: int) -> tuple[np.ndarray, np.ndarray]:
    """By the path and by MuJoCo, both 0 at rest on the lowest point."""
    world = drawn(params, name, number)
    moments = range(2 * APART, len(world.xyz_m) - 2 * APART, 10)
    around = [world.xyz_m[at - 2 * APART : at + 2 * APART + 1 : APART] for at in moments]
    found = [energy_j(world, params.physics, five, APART / params.camera.fps) for five in around]
    radius = np.array([ball.radius_m for ball in world.balls])
    at_rest = (DENSITY * 4 / 3 * np.pi * radius**4 * params.physics.gravity_m_s2).sum()
    return np.array(found), track(params, name, number).energy_j[list(moments)] - at_rest


@pytest.mark.parametrize("name", ["bowls", "bowlr_sim"])
def test_a_sliding_ball_has_mujocos_energy_but_for_the_spin_that_it_was_let_go_with(name: str) -> None:
    params = of_the_project(name)
    smooth = params.physics.model_copy(update={"friction": 0, "rolling_resistance_m": 0})
    for number in range(3):
        found, true = energies(params.model_copy(update={"physics": smooth}), name, number)
        assert np.ptp((found - true) / true[0]) < 0.004


@pytest.mark.parametrize("name", ["bowls", "bowlr_sim", "heights"])
def test_a_rolling_ball_has_mujocos_energy_less_that_of_its_spin_about_the_normal(name: str) -> None:
    for number in range(3):
        found, true = energies(of_the_project(name), name, number)
        assert ((found - true) / true[0]).min() > -0.2
        assert ((found - true) / true[0]).max() < 0.02


@pytest.mark.parametrize("name", ["bowls", "heights", "poolr_sim"])
def test_a_ball_seen_from_above_is_lifted_to_where_it_is(name: str) -> None:
    world = drawn(of_the_project(name), name, 0)
    xyz = world.xyz_m[::20]
    np.testing.assert_allclose(lifted(world, xyz[..., :2]), xyz, rtol=0, atol=2e-4)  # m


def test_beyond_the_border_the_terrain_goes_on_level() -> None:
    world = drawn(of_the_project("bowls"), "bowls", 0)
    far = lifted(world, np.array([[[5.0, 0.0]], [[9.0, 0.0]]]))[:, 0, 2]
    assert far[0] == far[1] > lifted(world, np.zeros((1, 1, 2)))[0, 0, 2]
