"""What a surface is made of, as seen from above: noise on several scales, like felt, papier-mache or wood."""

from typing import cast

import cv2
import numpy as np
from pydantic import Field

from physpipe.core.params import Section
from physpipe.scenes.film import Image


class TextureParams(Section):
    """Noise made of layers, each half as wide as the one before."""

    contrast: float = Field(ge=0, lt=1)
    """Standard deviation of the brightness, relative to the surface's."""
    colour: float = Field(ge=0, le=1)
    """Part of the noise that each colour channel has for itself."""
    widest_px: float = Field(ge=1)
    """Width of a patch of the coarsest layer, in source pixels."""
    layers: int = Field(ge=1)
    """Number of layers."""
    fade: float = Field(gt=0)
    """Contrast of a layer over that of the coarser one."""
    stretch: float = Field(ge=1)
    """Length of a patch along x over its width: 1 for felt or paper, more for threads or wood grain."""


def draw_texture(params: TextureParams, size: tuple[int, int], rng: np.random.Generator) -> Image:
    """(H, W, 3) factors around 1 for a picture of `size` = (width, height)."""
    width, height = size
    total = np.zeros((height, width, 3), np.float32)
    for layer in range(params.layers):
        patch = max(params.widest_px / 2**layer, 1)
        shape = int(np.ceil(height / patch)) + 1, int(np.ceil(width / patch / params.stretch)) + 1
        grey, colour = rng.standard_normal((*shape, 1), np.float32), rng.standard_normal((*shape, 3), np.float32)
        noise = (1 - params.colour) * grey + params.colour * colour
        smooth = cast(Image, cv2.resize(noise, size, interpolation=cv2.INTER_CUBIC))
        total += params.fade**layer * (smooth - smooth.mean()) / smooth.std()
    return np.maximum(1 + params.contrast * total / total.std(), 0)
