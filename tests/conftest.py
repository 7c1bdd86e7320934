"""One thread a test: small tensors gain nothing from more, and rounding then does not depend on the machine."""

import pytest
import torch


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    torch.set_num_threads(1)
