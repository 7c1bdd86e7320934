"""What the tests of experiments share."""

import pytest

from experiments import records


@pytest.fixture(autouse=True)
def costs(tmp_path, monkeypatch):
    monkeypatch.setattr(records, "COSTS", tmp_path / "costs")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    """What the experiments write belongs to no checkout."""
    monkeypatch.chdir(tmp_path)
