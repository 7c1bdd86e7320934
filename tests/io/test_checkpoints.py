"""Weights come back bit for bit; a checkpoint folder belongs to one code, params and input."""

from pathlib import Path

import pytest
import torch

from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.io import checkpoints


class RateParams(Section):
    """A stage's params."""

    rate: float
    """Any number."""


def test_weights_come_back_bit_for_bit(tmp_path: Path) -> None:
    state = {"weights": {"a": torch.randn(3, 5, generator=torch.Generator().manual_seed(1))}, "step": 7}
    checkpoints.save(tmp_path / "w.pt", state)
    found = checkpoints.load(tmp_path / "w.pt")
    assert torch.equal(found["weights"]["a"], state["weights"]["a"])  # type: ignore[index]
    assert found["step"] == 7


def test_absent_and_broken_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        checkpoints.load(tmp_path / "w.pt")
    (tmp_path / "w.pt").write_bytes(b"half a file")
    with pytest.raises(InputError, match="cannot be read as weights"):
        checkpoints.load(tmp_path / "w.pt")


def test_weights_of_another_model_are_refused(tmp_path: Path) -> None:
    weights = torch.nn.Linear(3, 5).state_dict()
    with pytest.raises(InputError, match="weights of another model"):
        checkpoints.load_into(torch.nn.Linear(3, 6), weights, tmp_path / "w.pt")


def test_scratch_changes_with_stage_params_and_input_bytes_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PHYSPIPE_SCRATCH", str(tmp_path / "scratch"))
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.npy").write_bytes(b"1")

    def folder(stage: str = "train", rate: float = 0.1) -> Path:
        return checkpoints.scratch(stage, [RateParams(rate=rate)], [tmp_path / "in"])

    first = folder()
    assert first == folder()
    assert first.is_relative_to(tmp_path / "scratch")
    assert len({first, folder("mask"), folder(rate=0.2)}) == 3
    (tmp_path / "in" / "a.npy").write_bytes(b"2")
    assert folder() != first


def test_forgotten_checkpoints_are_gone(tmp_path: Path) -> None:
    checkpoints.save(tmp_path / "run" / "w.pt", {"step": 1})
    checkpoints.forget(tmp_path / "run")
    checkpoints.forget(tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_the_same_values_give_the_same_bytes_whatever_the_file_is_called(tmp_path):
    state = {"weights": torch.arange(6.0), "name": "net"}
    checkpoints.save(tmp_path / "one.pt", state)
    checkpoints.save(tmp_path / "two.pt", state)
    assert (tmp_path / "one.pt").read_bytes() == (tmp_path / "two.pt").read_bytes()
