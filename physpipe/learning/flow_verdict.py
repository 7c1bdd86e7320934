"""How good a flow network is on pairs that it never saw, beside flow that nobody trained."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.determinism import torch_generator
from physpipe.core.params import Section
from physpipe.flownet import weights
from physpipe.flownet.inference import flows
from physpipe.flownet.network import CorrFlow
from physpipe.io import results
from physpipe.io.atomic import replacing_folder
from physpipe.io.pictures import save_png
from physpipe.learning.flow_film import Image, Pair, PairParams, draw_pairs

CURVE, PICTURE, VERDICT = "curve.csv", "pairs.png", "verdict.json"
TEST = (0, 0, 2)
"""Key of the pairs of the verdict; neither a training step's nor those that chose the weights."""
DIS_PRESETS = {
    "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
    "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
    "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
}
Grey = NDArray[np.uint8]


class FarnebackParams(Section):
    """OpenCV's `calcOpticalFlowFarneback`."""

    scale: float = Field(gt=0, lt=1)
    """Size of a pyramid's level over the next finer one's."""
    levels: int = Field(ge=1)
    """Levels of the pyramid."""
    window_px: int = Field(ge=3)
    """Side of the window over which flow is averaged."""
    iterations: int = Field(ge=1)
    """Iterations on each level."""
    neighbours_px: int = Field(ge=3)
    """Side of the patch that a polynomial is fitted to."""
    sigma_px: float = Field(gt=0)
    """Standard deviation of the weights in that patch."""


class VerdictParams(Section):
    """What the network is compared with, and on how much."""

    pairs: int = Field(ge=1)
    """Pairs drawn for the verdict alone."""
    shown: int = Field(ge=1)
    """Pairs of the picture, at most."""
    dis: Literal["ultrafast", "fast", "medium"]
    """Preset of OpenCV's DIS flow."""
    farneback: FarnebackParams


def save_flow(out: Path, net: CorrFlow, curve: pd.DataFrame, drawn: PairParams, params: VerdictParams) -> None:
    """Writes weights, learning curve, a few pairs with their flow, and the errors of all methods into a folder."""
    pairs = draw_pairs(drawn, params.pairs, torch_generator(*TEST))
    found = estimates(net, pairs, params)
    with replacing_folder(out) as folder:
        weights.save(folder, net)
        results.save_csv(folder / CURVE, curve)
        results.save_json(folder / VERDICT, verdict(pairs, found))
        save_png(folder / PICTURE, sheet(pairs[: params.shown], found["corrflow"], drawn.step_px))


def estimates(net: CorrFlow, pairs: Sequence[Pair], params: VerdictParams) -> dict[str, list[Image]]:
    """Method to its flow (H, W, 2) of every pair; `zero` says that nothing moves."""
    first, second = (np.stack([pair.frames[n] for pair in pairs]) for n in range(2))
    grey = [[cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY) for frame in pair.frames] for pair in pairs]
    untrained: Mapping[str, Callable[[Grey, Grey], Image]] = {
        "zero": lambda a, b: _still(a),
        "dis": lambda a, b: _dis(a, b, params.dis),
        "farneback": lambda a, b: _farneback(a, b, params.farneback),
    }
    found = {name: [method(a, b) for a, b in grey] for name, method in untrained.items()}
    return {"corrflow": list(flows(net, first, second, len(first))), **found}


def verdict(pairs: Sequence[Pair], found: Mapping[str, Sequence[Image]]) -> dict[str, dict[str, float]]:
    """Method to its mean endpoint error in pixels: over all pixels, and over those inside the balls."""
    true, inside = np.stack([pair.flow for pair in pairs]), np.stack([pair.inside for pair in pairs])
    errors = {name: np.linalg.norm(np.stack(each) - true, axis=-1) for name, each in found.items()}
    return {
        name: {"overall_px": float(each.mean()), "inside_px": float(each[inside].mean())}
        for name, each in errors.items()
    }


def sheet(pairs: Sequence[Pair], found: Sequence[Image], largest_px: float) -> NDArray[np.uint8]:
    """(H', W', 3) RGB, a row a pair: both frames, the true flow, the one found."""
    rows = [
        np.concatenate([*pair.frames, *(colour_wheel(each, largest_px) for each in (pair.flow, flow))], axis=1)
        for pair, flow in zip(pairs, found, strict=False)
    ]
    return np.concatenate(rows)


def colour_wheel(flow: Image, largest_px: float) -> NDArray[np.uint8]:
    """(H, W, 3) RGB of (H, W, 2): the hue is the direction, white is no motion, full colour `largest_px` or more."""
    length, degrees = cv2.cartToPolar(flow[..., 0], flow[..., 1], angleInDegrees=True)
    hsv = np.stack([degrees, np.minimum(length / largest_px, 1), np.ones_like(length)], axis=-1)
    return np.rint(255 * cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)).astype(np.uint8)


def _dis(first: Grey, second: Grey, preset: str) -> Image:
    method = cv2.DISOpticalFlow.create(DIS_PRESETS[preset])
    return np.asarray(method.calc(first, second, _still(first)), np.float32)


def _farneback(first: Grey, second: Grey, params: FarnebackParams) -> Image:
    settings = (params.scale, params.levels, params.window_px, params.iterations, params.neighbours_px, params.sigma_px)
    return np.asarray(cv2.calcOpticalFlowFarneback(first, second, _still(first), *settings, 0), np.float32)


def _still(frame: Grey) -> Image:
    return np.zeros((*frame.shape, 2), np.float32)
