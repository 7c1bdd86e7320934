"""Same machine, same commit, same numbers: fixed threads and explicit generators."""

import numpy as np
import torch
from pydantic import Field

from physpipe.core.params import Section


class ComputeParams(Section):
    """What makes two runs the same run."""

    seed: int = Field(ge=0)
    """Seed of everything learned; simulated worlds are fixed by name and clip number instead."""
    threads: int = Field(ge=1)
    """Threads of one training; another count gives other rounding, hence other metrics."""


def prepare(compute: ComputeParams) -> None:
    """Fixes threads, seeds what takes no generator (weight initialisation), refuses nondeterministic kernels."""
    torch.set_num_threads(compute.threads)
    torch.manual_seed(compute.seed)
    torch.use_deterministic_algorithms(True)


def torch_generator(*key: int) -> torch.Generator:
    """A CPU generator that depends on every number of `key`, e.g. (seed, step)."""
    seed = int(np.random.SeedSequence(key).generate_state(1, np.uint64)[0])
    return torch.Generator().manual_seed(seed & (2**63 - 1))


def device() -> torch.device:
    """The GPU when there is one, else the CPU."""
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")
