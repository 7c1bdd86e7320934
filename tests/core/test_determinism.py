"""The same key gives the same numbers."""

import torch

from physpipe.core.determinism import torch_generator


def test_a_generator_depends_on_every_number_of_its_key() -> None:
    def first(*key: int) -> float:
        return float(torch.rand(1, generator=torch_generator(*key)))

    assert first(1, 2) == first(1, 2)
    assert len({first(1, 2), first(2, 1), first(1, 3), first(1), first(1, 2, 3)}) == 5
