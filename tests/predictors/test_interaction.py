import pytest
import torch
from torch import nn

from physpipe.predictors.interaction import InteractionCore


def core() -> InteractionCore:
    torch.manual_seed(0)
    return InteractionCore(inputs=3, hidden=8, outputs=2)


def states(objects: int) -> torch.Tensor:
    return torch.randn(4, objects, 3, generator=torch.Generator().manual_seed(1))


@pytest.mark.parametrize("order", [[1, 0, 2, 3], [3, 0, 1, 2], [2, 3, 1, 0]])
def test_permuting_objects_permutes_the_result(order):
    step, some = core(), states(4)
    torch.testing.assert_close(step(some[:, order]), step(some)[:, order], rtol=0, atol=1e-6)


def test_relations_to_all_the_others_are_added_up():
    """With the parts replaced by plain sums: own state + the differences from each of the others."""

    class Difference(nn.Module):
        def forward(self, pairs: torch.Tensor) -> torch.Tensor:
            return pairs[..., 3:] - pairs[..., :3]

    class Last(nn.Module):
        def forward(self, both: torch.Tensor) -> torch.Tensor:
            return both[..., 3:]

    step = core()
    step.own, step.relation, step.affect, step.output = nn.Identity(), Difference(), nn.Identity(), Last()
    some = states(3)
    torch.testing.assert_close(step(some), some + some.sum(1, keepdim=True) - 3 * some)


def test_a_lone_object_has_no_relations():
    step = core()
    before = step(states(1))
    for weights in step.relation.parameters():
        nn.init.constant_(weights, torch.nan)
    torch.testing.assert_close(step(states(1)), before)
    assert step(states(2)).isnan().all()


def test_what_is_far_away_in_the_batch_has_no_say():
    step, some = core(), states(3)
    torch.testing.assert_close(step(some)[:1], step(some[:1]))
