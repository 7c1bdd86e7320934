"""How good a flow network is on pairs that it never saw, beside flow that nobody trained."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.determinism import torch_generator
from physpipe.core.params import Section
from physpipe.flow_learning.film import Image, Pair, PairParams, draw_pairs
from physpipe.flownet import weights
from physpipe.flownet.classical import Flow
from physpipe.flownet.inference import flows
from physpipe.flownet.network import CorrFlow
from physpipe.io import results
from physpipe.io.atomic import replacing_folder
from physpipe.io.pictures import save_png

CURVE, PICTURE, VERDICT = "curve.csv", "pairs.png", "verdict.json"
TEST = (0, 0, 2)
"""Key of the pairs of the verdict; neither a training step's nor those that chose the weights."""


class VerdictParams(Section):
    """What the network is compared with, and on how much."""

    pairs: int = Field(ge=1)
    """Pairs drawn for the verdict alone."""
    shown: int = Field(ge=1)
    """Pairs of the picture, at most."""


def save_flow(
    out: Path,
    net: CorrFlow,
    curve: pd.DataFrame,
    drawn: PairParams,
    params: VerdictParams,
    untrained: Mapping[str, Flow],
) -> None:
    """Writes weights, learning curve, a few pairs with their flow, and the errors of all methods into a folder."""
    pairs = draw_pairs(drawn, params.pairs, torch_generator(*TEST))
    found = estimates(net, pairs, untrained)
    with replacing_folder(out) as folder:
        weights.save(folder, net)
        results.save_csv(folder / CURVE, curve)
        results.save_json(folder / VERDICT, verdict(pairs, found))
        save_png(folder / PICTURE, sheet(pairs[: params.shown], found["corrflow"], drawn.step_px))


def estimates(net: CorrFlow, pairs: Sequence[Pair], untrained: Mapping[str, Flow]) -> dict[str, list[Image]]:
    """Method to its flow (H, W, 2) of every pair; `zero` says that nothing moves."""
    first, second = (np.stack([pair.frames[n] for pair in pairs]) for n in range(2))
    found = {name: [flow(*pair.frames) for pair in pairs] for name, flow in untrained.items()}
    still = [np.zeros_like(pair.flow) for pair in pairs]
    return {"corrflow": list(flows(net, first, second, len(first))), "zero": still, **found}


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
