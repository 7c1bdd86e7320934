"""A saved network comes back as it was; anything else is refused by name."""

import pytest
import torch

from physpipe.core.errors import InputError
from physpipe.flownet import weights
from physpipe.flownet.network import CorrFlow, CorrFlowParams
from physpipe.io import checkpoints

PARAMS = CorrFlowParams(channels=[8, 12], radii=[1, 1], decoder=8, contrast_px=9, inside_weight=1, level_weight=0.4)


def test_a_network_comes_back_as_it_was(tmp_path):
    torch.manual_seed(0)
    net = CorrFlow(PARAMS)
    weights.save(tmp_path, net)
    again = weights.load(tmp_path)
    assert again.params == PARAMS
    assert not again.training
    assert all(torch.equal(value, again.state_dict()[name]) for name, value in net.state_dict().items())


def test_a_missing_or_a_foreign_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"weights\.pt: no such file"):
        weights.load(tmp_path)
    checkpoints.save(tmp_path / weights.WEIGHTS, {"params": {"width": 3}, "state": {}})
    with pytest.raises(InputError, match="params of another model"):
        weights.load(tmp_path)
    checkpoints.save(tmp_path / weights.WEIGHTS, {"params": PARAMS.model_dump(), "state": {"a": torch.zeros(1)}})
    with pytest.raises(InputError, match="weights of another model"):
        weights.load(tmp_path)
