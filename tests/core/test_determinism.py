"""The same key gives the same numbers."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from physpipe.core.determinism import torch_generator


def test_a_generator_depends_on_every_number_of_its_key() -> None:
    def first(*key: int) -> float:
        return float(torch.rand(1, generator=torch_generator(*key)))

    assert first(1, 2) == first(1, 2)
    assert len({first(1, 2), first(2, 1), first(1, 3), first(1), first(1, 2, 3)}) == 5


def test_threads_that_wait_leave_their_core_to_others():
    asked = "import sys, physpipe.core, os; print(os.environ['OMP_WAIT_POLICY'], 'torch' in sys.modules)"
    clean = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    told = subprocess.run([sys.executable, "-c", asked], env=clean, capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["passive", "False"]  # OpenMP reads it when torch is imported


@pytest.mark.parametrize("stage", sorted(Path("stages").glob("[a-z]*.py")), ids=lambda path: path.stem)
def test_no_stage_imports_torch_before_the_threads_are_told_how_to_wait(stage):
    modules = [line.split()[1] for line in stage.read_text().splitlines() if line.startswith(("import ", "from "))]
    ours = next(number for number, module in enumerate(modules) if module.startswith("physpipe"))
    assert not {module.split(".")[0] for module in modules[:ours]} - set(sys.stdlib_module_names)
