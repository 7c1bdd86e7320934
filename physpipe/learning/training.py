"""The one loop that fits everything that learns; it knows no physics and no images."""

import copy
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import pandas as pd
import torch
from pydantic import Field
from torch import nn

from physpipe.core.determinism import device, torch_generator
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.core.precision import brief
from physpipe.core.progress import progress
from physpipe.io import checkpoints

Batch = Any
Sampler = Callable[[torch.Generator], Batch]
"""Draws one training batch from the generator alone, so that step n sees the same batch in a resumed run."""
Rank = tuple[float, ...]
"""How good a model is: compared in order, lower is better; the last is what the curve shows."""

MOST_LOST = 20
"""Steps in a row that may teach nothing, since a forecast ran away and its gradient is not finite."""


class FitParams(Section):
    """How long and how fast to learn."""

    steps: int = Field(ge=1)
    """Optimiser steps."""
    batch_size: int = Field(ge=1)
    """Samples a step."""
    learning_rate: float = Field(gt=0)
    """Adam's step size after the warm-up."""
    final_rate: float = Field(ge=0, le=1)
    """Share of the learning rate that is left at the last step (cosine decay; 1 = constant)."""
    warmup_steps: int = Field(ge=0)
    """Steps over which the learning rate grows from 0."""
    weight_decay: float = Field(ge=0)
    """AdamW's decoupled weight decay per unit of learning rate."""
    clip_norm: float = Field(gt=0)
    """Largest norm of the gradient."""
    valid_every: int = Field(ge=1)
    """Steps between two validations; each also writes a checkpoint."""
    patience: int = Field(ge=1)
    """Validations without a gain before stopping."""
    precision: Literal["float32", "bfloat16"]
    """Type of the autocast forward pass; float32 also where the machine has no bfloat16."""


class _Run:
    """Everything that a checkpoint must hold for a resumed training to end as an undisturbed one."""

    def __init__(self, model: Any, params: FitParams):
        self.model, self.params = model, params
        self.optimiser = torch.optim.AdamW(
            model.parameters(), lr=params.learning_rate, weight_decay=params.weight_decay
        )
        self.step, self.stale, self.lost = 0, 0, 0
        self.best: Rank = (math.inf,)
        self.weights = copy.deepcopy(model.state_dict())
        self.curve: list[dict[str, float]] = []

    def state(self) -> dict[str, Any]:
        return {
            "model": self.model.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "weights": self.weights,
            "progress": {
                "step": self.step,
                "best": self.best,
                "stale": self.stale,
                "lost": self.lost,
                "curve": self.curve,
            },
        }

    def restore(self, state: dict[str, Any]) -> None:
        self.model.load_state_dict(state["model"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.weights = state["weights"]
        for name, value in state["progress"].items():
            setattr(self, name, value)

    def judge(self, rank: Rank) -> None:
        """Keeps the weights of the lowest rank."""
        self.stale += 1
        if rank < self.best:
            self.best, self.stale = rank, 0
            self.weights = copy.deepcopy(self.model.state_dict())


def fit(
    model: Any,
    sample: Sampler,
    validate: Callable[[], Rank],
    params: FitParams,
    seed: int,
    checkpoint: Path,
    what: str,
) -> pd.DataFrame:
    """Fits `model`, a module whose `loss(batch, generator)` gives a scalar and its parts, and no other randomness.

    Leaves it with the weights of its lowest `validate()`; returns the curve, a row a validation.
    Goes on from `checkpoint` when that file exists, which its caller removes once the result is safe.
    """
    run = _Run(model.to(device(), memory_format=torch.channels_last), params)
    if checkpoint.exists():
        run.restore(checkpoints.load(checkpoint))
    for step in progress(range(run.step + 1, params.steps + 1), what, total=params.steps, start=run.step):
        if run.stale >= params.patience:
            break
        parts = _update(run, sample, torch_generator(seed, step))
        run.step = step
        if step % params.valid_every == 0 or step == params.steps:
            rank = _validated(model, validate)
            run.judge(rank)
            run.curve.append({"step": step, **parts, "valid": rank[-1]})
            checkpoints.save(checkpoint, run.state())
    model.load_state_dict(run.weights)
    model.eval()
    return pd.DataFrame(run.curve)


def _update(run: _Run, sample: Sampler, generator: torch.Generator) -> dict[str, float]:
    run.model.train()
    for group in run.optimiser.param_groups:
        group["lr"] = _rate(run.step, run.params)
    run.optimiser.zero_grad(set_to_none=True)
    with brief(run.params.precision == "bfloat16"):
        loss, parts = run.model.loss(sample(generator), generator)
    loss.backward()
    norm = nn.utils.clip_grad_norm_(run.model.parameters(), run.params.clip_norm)
    run.lost = 0 if torch.isfinite(norm) else run.lost + 1
    if run.lost == 0:
        run.optimiser.step()
    elif run.lost == MOST_LOST:
        reason = f"no finite gradient in {MOST_LOST} steps in a row"
        raise InputError("this training", reason, "lower its `learning_rate` in params.yaml")
    return {"train": loss.item(), **parts}


def _validated(model: nn.Module, validate: Callable[[], Rank]) -> Rank:
    model.eval()
    with torch.no_grad():
        return validate()


def _rate(step: int, params: FitParams) -> float:
    warm = min(1.0, (step + 1) / (params.warmup_steps + 1))
    decay = 0.5 * (1 + math.cos(math.pi * step / params.steps))
    return params.learning_rate * warm * (params.final_rate + (1 - params.final_rate) * decay)
