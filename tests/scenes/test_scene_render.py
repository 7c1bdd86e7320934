import numpy as np
import pytest

from physpipe.scenes.balls import Ball
from physpipe.scenes.bowl import Bowl
from physpipe.scenes.film import Camera
from physpipe.scenes.look import Light
from physpipe.scenes.render import Scene, draw_terrain
from physpipe.scenes.table import Table, TableParams
from physpipe.scenes.texture import TextureParams
from physpipe.scenes.world_params import WorldParams

TEXTURE = TextureParams(contrast=0.1, colour=0.2, widest_px=12, layers=3, fade=0.8, stretch=1.5)


def test_higher_ball_hides_the_lower(world: WorldParams) -> None:
    camera = Camera(world.camera.model_copy(update={"wobble_px": 0}), 2, np.random.default_rng(0))
    rng = np.random.default_rng(1)
    scene = Scene(world.look, Bowl(world.terrain, np.random.default_rng(0)), camera, rng, rng)
    xyz = np.zeros((2, 2, 3))
    xyz[0, 0, 2] = xyz[1, 1, 2] = 0.1
    red_over, blue_over = scene.film(xyz, camera.project(xyz), [Ball((255, 0, 0), 0.03), Ball((0, 0, 255), 0.03)])
    column, row = np.rint(camera.centre).astype(int)
    assert red_over[row, column, 0] > red_over[row, column, 2]
    assert blue_over[row, column, 2] > blue_over[row, column, 0]


def test_slope_towards_the_lamp_is_brighter(world: WorldParams) -> None:
    plain = world.look.model_copy(update={"tint": 0, "mottle": 0, "contour_contrast": 0})
    camera = Camera(world.camera.model_copy(update={"off_centre_px": 0}), 2, np.random.default_rng(0))
    bowl = Bowl(world.terrain, np.random.default_rng(0))
    lamp = Light(np.array([0.5, 0.0, np.sqrt(0.75)]))  # on the right, so the left wall faces it
    picture = draw_terrain(plain, bowl, camera, lamp, np.random.default_rng(1))
    column, row = np.rint(camera.centre).astype(int)
    assert picture[row, column - 20, 0] > picture[row, column, 0] > picture[row, column + 20, 0]


def test_cushions_are_a_darker_band_around_the_cloth(world: WorldParams) -> None:
    """Brightness along the table's long axis: cloth, then a band as wide as `rim` says, then what lies around."""
    table = Table(
        TableParams(kind="table", fixed=True, half_sides_m=(0.3, 0.2), restitution=1), np.random.default_rng(0)
    )
    look = world.look.model_copy(
        update={"tint": 0, "mottle": 0, "contour_contrast": 0, "rim": 0.1, "rim_brightness": 0.5, "ambient": 1}
    )
    camera = Camera(world.camera.model_copy(update={"off_centre_px": 0}), 2, np.random.default_rng(0))
    picture = draw_terrain(look, table, camera, Light(np.array([0.0, 0.0, 1.0])), np.random.default_rng(1))
    column, row = np.rint(camera.centre).astype(int)
    half = 0.3 * world.camera.pixels_per_metre  # 48 px to the nose, 4.8 px of cushion
    cloth, band, around = (picture[row, round(column + half + away), 0] for away in (-4, 2, 8))
    assert band / cloth == pytest.approx(0.5, rel=1e-5)
    assert around / cloth == pytest.approx(look.table_brightness, rel=1e-5)


def test_texture_keeps_its_place_on_the_terrain(world: WorldParams) -> None:
    """Another camera position shifts the whole picture, texture included, by that many pixels."""
    look = world.look.model_copy(update={"mottle": 0, "texture": TEXTURE})
    pictures = []
    for away in (0, 3):
        camera = Camera(world.camera.model_copy(update={"off_centre_px": 0}), 2, np.random.default_rng(0))
        camera.centre = camera.centre + away
        bowl = Bowl(world.terrain, np.random.default_rng(0))
        lamp = Light(np.array([0.0, 0.0, 1.0]))
        pictures.append(draw_terrain(look, bowl, camera, lamp, np.random.default_rng(1)))
    np.testing.assert_allclose(pictures[1][20:-20, 20:-20], pictures[0][17:-23, 17:-23], rtol=1e-4)
