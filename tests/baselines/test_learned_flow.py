"""A trained network serves as the flow of any two frames and of a whole clip."""

import pickle

import numpy as np
import pytest
import torch

from physpipe.baselines.learned_flow import LearnedFlow, LearnedFlowParams
from physpipe.core.errors import InputError
from physpipe.flownet import weights
from physpipe.flownet.network import CorrFlow, CorrFlowParams

FRAMES = np.random.default_rng(0).integers(0, 255, (5, 37, 51, 3), dtype=np.uint8)


@pytest.fixture
def flow(tmp_path) -> LearnedFlow:
    torch.manual_seed(0)
    net = CorrFlow(
        CorrFlowParams(channels=[8, 12], radii=[1, 1], decoder=8, contrast_px=9, inside_weight=1, level_weight=0.4)
    )
    for level in net.levels:
        torch.nn.init.normal_(level.correct.weight, std=0.3)
    weights.save(tmp_path, net)
    return LearnedFlow(tmp_path, LearnedFlowParams(batch_pairs=3))


def test_a_clip_s_flow_is_that_of_its_pairs(flow):
    clip = flow.of_clip(FRAMES)
    assert clip.shape == (4, 37, 51, 2)
    for found, first, second in zip(clip, FRAMES[:-1], FRAMES[1:], strict=True):
        np.testing.assert_allclose(found, flow(first, second), atol=0.05)  # px; bfloat16 rounds to 3 digits


def test_a_single_frame_has_no_flow(flow):
    assert flow.of_clip(FRAMES[:1]).shape == (0, 37, 51, 2)


def test_it_crosses_a_process_pool_unchanged(flow):
    again = pickle.loads(pickle.dumps(flow))
    np.testing.assert_array_equal(again.of_clip(FRAMES), flow.of_clip(FRAMES))


def test_a_folder_without_a_network_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        LearnedFlow(tmp_path, LearnedFlowParams(batch_pairs=3))
