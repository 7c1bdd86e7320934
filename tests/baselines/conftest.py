"""The project's own numbers for the baselines, and a disc on a textured ground."""

from pathlib import Path

import pytest

from physpipe.baselines.zoo import BaselineParams
from physpipe.core.params import read

PARAMS = Path(__file__).parents[2] / "params.yaml"


@pytest.fixture
def params() -> BaselineParams:
    return read("baselines", BaselineParams, PARAMS)
