"""Whether the simulated sets move as hard as the paper's, told from two extrapolations of true positions."""

import numpy as np
import pytest
from simulated import PARAMS, of_the_project

from physpipe.core import params
from physpipe.scenes.film import Camera
from physpipe.scenes.world_params import WorldParams
from physpipe.scenes.worlds import track

PAPER_PX = {
    "bowls": {1: (20.1, 61.9), 2: (11.7, 93.1)},
    "heights": {1: (21.3, 61.9), 2: (26.7, 126.0)},
}
"""Set and degree of the polynomial: mean error at frames 20 and 40 that the paper prints for BowlS and HeightS."""


def extrapolated(xy: np.ndarray, degree: int, frame: int) -> np.ndarray:
    """(clips, 2) least-squares polynomial of the first 10 of (clips, F, 2) positions, at a later frame."""
    weights = np.vander([frame], degree + 1) @ np.linalg.pinv(np.vander(np.arange(10.0), degree + 1))
    return np.einsum("f,cfd->cd", weights[0], xy[:, :10])


def filmed(world: WorldParams, name: str, number: int) -> np.ndarray:
    """(F, K, 2) source pixels from the release on, the camera's wobble included, which no polynomial foresees."""
    xyz = track(world, name, number).xyz_m
    return Camera(world.camera, len(xyz), np.random.default_rng(number)).project(xyz)


@pytest.mark.parametrize("name", list(PAPER_PX))
def test_motion_is_as_hard_as_the_papers(name: str) -> None:
    """What "error at T" means depends on the motion: both extrapolations must err as they did in the paper."""
    world = of_the_project(name).model_copy(update={"moving_frames": 130})
    crop = params.read_value(f"datasets.{name}.ingest.crop", PARAMS)
    scale = 128 / (crop["width"] if crop else min(world.camera.width, world.camera.height))
    xy = scale * np.stack([filmed(world, name, number)[:126:3, 0] for number in range(80)])
    for degree, errors in PAPER_PX[name].items():
        for frame, paper in zip((20, 40), errors, strict=True):
            error = np.linalg.norm(extrapolated(xy[:, 1:], degree, frame) - xy[:, 1 + frame], axis=1).mean()
            assert error == pytest.approx(paper, rel=0.15), (degree, frame)
