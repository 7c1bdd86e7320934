"""Flow of film frames: batches change nothing, and the frames' own size comes back."""

import numpy as np
import torch

from physpipe.flownet.inference import flows
from physpipe.flownet.network import CorrFlow, CorrFlowParams

PARAMS = CorrFlowParams(channels=[8, 12], radii=[1, 1], decoder=8, contrast_px=9, inside_weight=1, level_weight=0.4)


def test_each_pair_has_its_own_flow_whatever_the_batches():
    torch.manual_seed(0)
    net = CorrFlow(PARAMS)
    for level in net.levels:
        torch.nn.init.normal_(level.correct.weight, std=0.3)
    frames = np.random.default_rng(0).integers(0, 255, (6, 37, 51, 3), dtype=np.uint8)
    whole = list(flows(net, frames[:-1], frames[1:], 5))
    assert [each.shape for each in whole] == [(37, 51, 2)] * 5
    assert all(each.dtype == np.float32 for each in whole)
    for single, each in zip(flows(net, frames[:-1], frames[1:], 2), whole, strict=True):
        np.testing.assert_allclose(single, each, atol=0.05)  # px; bfloat16 rounds each layer to 3 digits
    assert np.abs(whole[0] - whole[1]).max() > 0.1
