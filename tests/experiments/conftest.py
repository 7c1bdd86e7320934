"""What the tests of experiments share."""

import pytest

from experiments import records


@pytest.fixture(autouse=True)
def costs(tmp_path, monkeypatch):
    monkeypatch.setattr(records, "COSTS", tmp_path / "costs")
