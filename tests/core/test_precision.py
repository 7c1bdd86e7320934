"""Which numbers networks compute in."""

import pytest
import torch

from physpipe.core import precision
from physpipe.core.precision import brief, has_bfloat16


@pytest.fixture(autouse=True)
def _asked_anew():
    has_bfloat16.cache_clear()
    yield
    has_bfloat16.cache_clear()


def product() -> torch.dtype:
    one = torch.ones(2, 2)
    return (one @ one).dtype


@pytest.mark.parametrize(
    ("capabilities", "there"),
    [
        ({"avx2": True, "avx512_bf16": False, "amx_bf16": False}, False),
        ({"avx2": True, "avx512_bf16": True, "amx_bf16": False}, True),
        ({"avx512_f": True, "cpu_name": "one"}, False),
    ],
)
def test_a_processor_without_bfloat16_computes_in_float32(monkeypatch, capabilities, there):
    monkeypatch.setattr(precision, "device", lambda: torch.device("cpu"))
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: capabilities)
    assert has_bfloat16() is there
    with brief():
        assert product() == (torch.bfloat16 if there else torch.float32)


def test_what_does_not_want_it_is_left_in_float32(monkeypatch):
    monkeypatch.setattr(precision, "has_bfloat16", lambda: True)
    with brief(wanted=False):
        assert product() == torch.float32
