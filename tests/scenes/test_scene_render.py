import numpy as np

from physpipe.scenes.film import Camera
from physpipe.scenes.look import Light
from physpipe.scenes.render import Scene, draw_terrain
from physpipe.scenes.terrain import Bowl
from physpipe.scenes.worlds import WorldParams


def test_higher_ball_hides_the_lower(world: WorldParams) -> None:
    camera = Camera(world.camera.model_copy(update={"wobble_px": 0}), 2, np.random.default_rng(0))
    scene = Scene(world.look, Bowl(world.terrain, np.random.default_rng(0)), camera, np.random.default_rng(1))
    xyz = np.zeros((2, 2, 3))
    xyz[0, 0, 2] = xyz[1, 1, 2] = 0.1
    red_over, blue_over = scene.film(xyz, camera.project(xyz), 0.03, [(255, 0, 0), (0, 0, 255)])
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
