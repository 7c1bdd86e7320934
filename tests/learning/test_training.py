import math

import pytest
import torch
from torch import Tensor, nn

from physpipe.core.errors import InputError
from physpipe.io import checkpoints
from physpipe.learning.training import FitParams, Rank, fit

PARAMS = FitParams(
    steps=12, batch_size=8, learning_rate=1e-2, final_rate=0.1, warmup_steps=3, weight_decay=1e-2, clip_norm=1.0,
    valid_every=4, patience=100, precision="float32",
)  # fmt: skip


class Line(nn.Module):
    """y = a x + b with a noisy loss, so that every random number counts; `fails_at` breaks it at a step."""

    def __init__(self, fails_at: int = 0):
        super().__init__()
        torch.manual_seed(0)
        self.line = nn.Sequential(nn.Linear(1, 4), nn.BatchNorm1d(4), nn.Linear(4, 1))
        self.calls, self.fails_at = 0, fails_at

    def loss(self, batch: Tensor, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        self.calls += 1
        if self.calls == self.fails_at:
            raise KeyboardInterrupt
        noise = 0.1 * torch.randn(batch.shape, generator=generator)
        loss = (self.line(batch) - (3 * batch + 1) - noise).square().mean()
        return loss, {"part": 2 * loss.item()}


def sample(generator: torch.Generator) -> Tensor:
    return torch.rand(PARAMS.batch_size, 1, generator=generator)


def error_of(model: Line):
    x = torch.linspace(0, 1, 9)[:, None]
    return lambda: ((model.line(x) - (3 * x + 1)).square().mean().item(),)


def learned(checkpoint, model=None, params=PARAMS, validate=None, seed=5):
    model = model or Line()
    curve = fit(model, sample, validate or error_of(model), params, seed, checkpoint, "line")
    return model, curve


@pytest.mark.parametrize("fails_at", [2, 5, 11])
def test_a_killed_training_goes_on_to_bit_identical_weights(tmp_path, fails_at):
    whole, whole_curve = learned(tmp_path / "whole.pt")
    with pytest.raises(KeyboardInterrupt):
        learned(tmp_path / "killed.pt", Line(fails_at))
    resumed, curve = learned(tmp_path / "killed.pt")
    assert resumed.calls < PARAMS.steps or fails_at <= PARAMS.valid_every
    for name, weights in whole.state_dict().items():
        assert torch.equal(weights, resumed.state_dict()[name]), name
    assert curve.equals(whole_curve)


def test_the_curve_has_a_row_a_validation_with_the_losses_parts(tmp_path):
    _, curve = learned(tmp_path / "c.pt")
    assert curve["step"].tolist() == [4, 8, 12]
    assert list(curve.columns) == ["step", "train", "part", "valid"]
    torch.testing.assert_close(torch.tensor(curve["part"]), 2 * torch.tensor(curve["train"]))


def test_it_learns(tmp_path):
    model, curve = learned(tmp_path / "c.pt", params=PARAMS.model_copy(update={"steps": 400, "learning_rate": 0.05}))
    assert curve["valid"].iloc[-1] < curve["valid"].iloc[0] / 10


def test_the_best_weights_are_kept_and_patience_ends_a_hopeless_run(tmp_path):
    scores, seen = iter([2.0, 1.0, 3.0, 4.0, 5.0]), []
    model = Line()

    def validate() -> Rank:
        seen.append({name: each.clone() for name, each in model.state_dict().items()})
        return (next(scores),)

    _, curve = learned(tmp_path / "c.pt", model, PARAMS.model_copy(update={"steps": 400, "patience": 2}), validate)
    assert curve["valid"].tolist() == [2.0, 1.0, 3.0, 4.0]
    assert all(torch.equal(model.state_dict()[name], best) for name, best in seen[1].items())
    assert not model.training


def test_what_ranks_first_counts_before_the_score_that_the_curve_shows(tmp_path):
    ranks, seen = iter([(True, 1.0), (False, 5.0), (True, 0.5)]), []
    model = Line()

    def validate() -> Rank:
        seen.append({name: each.clone() for name, each in model.state_dict().items()})
        return next(ranks)

    _, curve = learned(tmp_path / "c.pt", model, validate=validate)
    assert curve["valid"].tolist() == [1.0, 5.0, 0.5]
    assert all(torch.equal(model.state_dict()[name], kept) for name, kept in seen[1].items())


def test_other_seeds_draw_other_batches(tmp_path):
    losses = [learned(tmp_path / f"{seed}.pt", seed=seed)[1]["train"].iloc[0] for seed in (5, 6)]
    assert losses[0] != losses[1]


def test_the_rate_warms_up_then_falls_by_a_cosine_to_its_final_share(tmp_path):
    learned(tmp_path / "c.pt")
    last = checkpoints.load(tmp_path / "c.pt")["optimiser"]["param_groups"][0]["lr"]
    step = PARAMS.steps - 1  # counted from 0
    cosine = 0.5 * (1 + math.cos(math.pi * step / PARAMS.steps))
    assert last == pytest.approx(PARAMS.learning_rate * (0.1 + 0.9 * cosine))


class Runaway(Line):
    """As Line, but its loss, hence its gradient, is infinite from step `first` to step `last`."""

    def __init__(self, first: int, last: int):
        super().__init__()
        self.first, self.last = first, last

    def loss(self, batch: Tensor, generator: torch.Generator) -> tuple[Tensor, dict[str, float]]:
        loss, parts = super().loss(batch, generator)
        return loss * (math.inf if self.first <= self.calls <= self.last else 1), parts


def test_a_step_whose_gradient_is_not_finite_teaches_nothing_and_ends_nothing(tmp_path):
    model, curve = learned(tmp_path / "fit.pt", Runaway(first=5, last=6))
    assert all(torch.isfinite(weights).all() for weights in model.parameters())
    assert curve["step"].iloc[-1] == PARAMS.steps


def test_a_training_that_never_has_a_finite_gradient_is_ended_with_the_mend(tmp_path):
    with pytest.raises(InputError, match=r"no finite gradient in 20 steps in a row.*learning_rate"):
        learned(tmp_path / "fit.pt", Runaway(first=1, last=99), PARAMS.model_copy(update={"steps": 40}))
