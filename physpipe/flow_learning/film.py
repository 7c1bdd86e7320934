"""Pairs of pictures with the exact flow between them, drawn like simulated film: lit ground, balls, a shaken camera."""

from typing import NamedTuple, cast

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field, model_validator

from physpipe.core.images import as_images
from physpipe.core.params import Section
from physpipe.flownet.network import FlowPairs
from physpipe.scenes.balls import Smear, draw_ball, draw_shadow
from physpipe.scenes.look import Light, LookParams

Image = NDArray[np.float32]


class PairParams(Section):
    """What is drawn, each pair anew."""

    size: int = Field(ge=32, multiple_of=8)
    """Side of the pictures in pixels."""
    balls: tuple[int, int]
    """Range of the number of balls."""
    radius_px: tuple[float, float]
    """Range of a ball's radius."""
    rgb: tuple[int, int]
    """Range of each of a ball's colour channels, 0 to 255."""
    step_px: float = Field(ge=0)
    """Largest way of a ball in the picture, the camera's shift included."""
    camera_px: float = Field(ge=0)
    """Largest shift of the ground in the picture."""
    exposure: tuple[float, float]
    """Range of the share of a ball's way during which the shutter is open."""
    shutter_moments: int = Field(ge=1)
    """Moments of an exposure that are averaged."""
    drift: float = Field(ge=0, lt=1)
    """Largest relative change of the light between the two."""
    noise: tuple[float, float]
    """Range of the sensor's noise: standard deviation in grey levels."""
    pixels_per_metre: float = Field(gt=0)
    """Scale of the ground's hills and contour rings."""
    hill_m: tuple[float, float]
    """Range of the hills' height, standard deviation in metres."""
    hill_px: int = Field(ge=4)
    """Distance between hills."""
    look: LookParams
    """Colours and light; the ground's patches are up to `mottle_px` wide and vary by up to `mottle`."""

    @model_validator(mode="after")
    def _ranges_are_ordered_and_balls_fit(self) -> "PairParams":
        for name in ("balls", "radius_px", "rgb", "exposure", "noise", "hill_m"):
            low, high = getattr(self, name)
            if not 0 <= low <= high:
                raise ValueError(f"{name} [{low}, {high}] is no range of numbers from 0 on")
        if 2 * self.radius_px[1] + self.step_px > self.size - 1:
            raise ValueError("the largest ball on its longest way does not fit into a picture")
        return self


class Pair(NamedTuple):
    """One scene at two moments."""

    frames: NDArray[np.uint8]
    """(2, H, W, 3) RGB."""
    flow: Image
    """(H, W, 2) pixels (x, y) from the first to the second."""
    inside: NDArray[np.bool_]
    """(H, W) pixels of a ball in the first."""


def draw_pairs(params: PairParams, count: int, generator: torch.Generator) -> list[Pair]:
    """New pairs; a function of the generator alone."""
    rng = np.random.default_rng(int(torch.randint(2**62, (), generator=generator)))
    return [draw_pair(params, rng) for _ in range(count)]


def as_batch(pairs: list[Pair]) -> FlowPairs:
    """The pairs as tensors on the computing device."""
    first, second = (as_images(np.stack([pair.frames[n] for pair in pairs])) for n in range(2))
    flow = torch.from_numpy(np.stack([pair.flow for pair in pairs])).movedim(-1, 1)
    inside = torch.from_numpy(np.stack([pair.inside for pair in pairs]))
    return FlowPairs(first, second, flow.to(first.device), inside.to(first.device))


def draw_pair(params: PairParams, rng: np.random.Generator) -> Pair:
    """A new ground, light, camera shift and set of balls; a later ball hides an earlier one."""
    size, light = (params.size, params.size), Light.sample(params.look, rng)
    shift = _within_disc(params.camera_px, rng)
    pictures = _filmed(draw_ground(params, light, rng), shift, params.size, rng)
    flow = np.broadcast_to(shift.astype(np.float32), (*size, 2)).copy()
    inside = np.zeros(size, bool)
    shadows, balls = [], []
    for _ in range(rng.integers(params.balls[0], params.balls[1] + 1)):
        radius, way = rng.uniform(*params.radius_px), _within_disc(params.step_px, rng)
        first = _place(radius, way, params.size, rng)
        smear = _smear(first, way, params, rng)
        red, green, blue = rng.integers(params.rgb[0], params.rgb[1] + 1, 3).tolist()
        shadows.append(draw_shadow(smear, radius, light, params.look))
        balls.append(draw_ball(smear, radius, (red, green, blue), light, params.look))
        disc = np.hypot(*(np.mgrid[: size[0], : size[1]] - first[::-1, None, None])) <= radius
        flow[disc], inside = way, inside | disc
    for frame, picture in enumerate(pictures):
        for layer in [*shadows, *balls]:
            layer.paint(picture, frame)
    return Pair(_exposed(pictures, params, rng), flow, inside)


def _smear(first: NDArray[np.float64], way: NDArray[np.float64], params: PairParams, rng: np.random.Generator) -> Smear:
    """A ball at both moments, blurred alike by its way."""
    blur = rng.uniform(*params.exposure) * way
    centres = np.stack([first, first + way])
    return Smear(centres, np.stack([blur, blur]), params.shutter_moments, (params.size, params.size))


def draw_ground(params: PairParams, light: Light, rng: np.random.Generator) -> Image:
    """(H', W', 3), 0 to 255, a margin larger than a picture: hills with contour rings inside a bright elliptic rim."""
    look, side = params.look, params.size + 2 * margin(params)
    z = rng.uniform(*params.hill_m) * _smooth_noise(side, params.hill_px, rng)
    slope_y, slope_x = np.gradient(z * params.pixels_per_metre)
    towards = light.towards.astype(np.float32)
    facing = (towards[2] - slope_x * towards[0] - slope_y * towards[1]) / np.sqrt(1 + slope_x**2 + slope_y**2)
    shade = look.ambient + (1 - look.ambient) * np.maximum(facing, 0)
    shade *= 1 - look.contour_contrast * np.cos(np.pi * z / look.contour_m) ** 8
    centre, axes = rng.uniform(0.25, 0.75, 2) * side, rng.uniform(0.3, 0.9, 2) * side
    y, x = np.ogrid[:side, :side]
    level = np.hypot((x - centre[0]) / axes[0], (y - centre[1]) / axes[1])
    shade = np.where(level < 1, shade, np.where(level < 1 + look.rim, look.rim_brightness, look.table_brightness))
    mottle, width = rng.uniform(0, look.mottle), int(rng.integers(2, look.mottle_px + 1))
    shade = shade * (1 + mottle * _smooth_noise(side, width, rng))
    tone = rng.uniform(*look.surface_grey) + rng.uniform(-look.tint, look.tint, 3)
    return (shade[..., None] * tone).astype(np.float32)


def margin(params: PairParams) -> int:
    """Pixels by which the drawn ground exceeds a picture on each side."""
    return int(np.ceil(params.camera_px)) + 2


def _filmed(ground: Image, shift: NDArray[np.float64], size: int, rng: np.random.Generator) -> list[Image]:
    """The ground at two moments, (size, size, 3) each; both fall between pixels, so that both are equally soft."""
    edge = (len(ground) - size) / 2
    start = rng.uniform(-0.5, 0.5, 2) - shift / 2 - edge
    moved = [np.array([[1, 0, dx], [0, 1, dy]]) for dx, dy in (start, start + shift)]
    return [cast(Image, cv2.warpAffine(ground, each, (size, size), borderMode=cv2.BORDER_REPLICATE)) for each in moved]


def _exposed(pictures: list[Image], params: PairParams, rng: np.random.Generator) -> NDArray[np.uint8]:
    gains = (1, 1 + params.drift * rng.uniform(-1, 1))
    grain = rng.standard_normal((2, *pictures[0].shape), np.float32) * np.float32(rng.uniform(*params.noise))
    bright = np.stack([picture * np.float32(gain) for picture, gain in zip(pictures, gains, strict=True)])
    return np.clip(np.rint(bright + grain), 0, 255).astype(np.uint8)


def _place(radius: float, way: NDArray[np.float64], size: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """A first centre from which the whole ball stays in the picture."""
    low, high = radius - np.minimum(way, 0), size - 1 - radius - np.maximum(way, 0)
    return rng.uniform(low, high)


def _within_disc(largest: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """A vector of any direction and any length up to `largest`."""
    angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0, largest)
    return length * np.array([np.cos(angle), np.sin(angle)])


def _smooth_noise(side: int, patch: int, rng: np.random.Generator) -> Image:
    """(side, side) standard normal values `patch` pixels apart, smooth in between."""
    count = side // patch + 2
    coarse = rng.standard_normal((count, count), np.float32)
    return cast(Image, cv2.resize(coarse, (side, side), interpolation=cv2.INTER_CUBIC))
