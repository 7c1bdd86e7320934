"""What all tests share: one thread a test, and the browser that tests of pages drive."""

import os
import shutil

import pytest
import torch


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Small tensors gain nothing from more, and rounding then does not depend on the machine."""
    torch.set_num_threads(1)


@pytest.fixture(scope="session")
def chromium() -> str:
    """The system's Chromium; without one the test is skipped, and fails where `CI` is set, which has to have it."""
    found = shutil.which("chromium")
    if found is None and os.environ.get("CI"):
        pytest.fail("no `chromium` on this machine, and `CI` is set: install it, as by `apt-get install chromium`")
    if found is None:
        pytest.skip("no `chromium` on this machine")
    return found
