"""Errors of exact and of no flow are known, colours mean directions, and a folder holds what it says."""

import numpy as np
import pandas as pd
import pytest
import torch
from small_flow import params

from physpipe.core.determinism import torch_generator
from physpipe.flow_learning import verdict as flow_verdict
from physpipe.flow_learning.film import draw_pairs
from physpipe.flow_learning.verdict import colour_wheel, estimates, save_flow, sheet, verdict
from physpipe.flownet import weights
from physpipe.flownet.classical import DisParams, FarnebackParams, classical_flows
from physpipe.flownet.network import CorrFlow
from physpipe.io import results

PARAMS = params(3)
CLASSICAL = classical_flows(
    DisParams(finest_scale=0, patch_px=4, stride_px=2, refinements=0),
    FarnebackParams(levels=2, window_px=5, rounds=2, neighbours_px=5, spread_px=1.1),
)
PAIRS = draw_pairs(PARAMS.pairs, 6, torch_generator(0))


def untrained() -> CorrFlow:
    torch.manual_seed(0)
    return CorrFlow(PARAMS.network)


def test_the_true_flow_has_no_error_and_no_flow_errs_by_the_motion():
    true = [pair.flow for pair in PAIRS]
    errors = verdict(PAIRS, {"true": true, "zero": [np.zeros_like(each) for each in true]})
    assert errors["true"] == {"overall_px": 0, "inside_px": 0}
    inside = np.concatenate([pair.flow[pair.inside] for pair in PAIRS])
    assert errors["zero"]["inside_px"] == pytest.approx(np.linalg.norm(inside, axis=1).mean(), rel=1e-5)


def test_every_method_gives_a_flow_of_every_pair():
    found = estimates(untrained(), PAIRS, CLASSICAL)
    assert set(found) == {"corrflow", "zero", "dis", "farneback"}
    for flows in found.values():
        assert [each.shape for each in flows] == [(32, 32, 2)] * 6


def test_colours_tell_direction_and_length():
    flow = np.array([[[0, 0], [6, 0], [60, 0], [-6, 0], [3, 0]]], np.float32)
    white, right, far, left, half = colour_wheel(flow, 6)[0].tolist()
    assert white == [255, 255, 255]
    assert right == far == [255, 0, 0]
    assert left == [0, 255, 255]
    assert half == [255, 128, 128]


def test_a_folder_holds_weights_curve_picture_and_verdict(tmp_path):
    net = untrained()
    save_flow(
        tmp_path / "flow", net, pd.DataFrame({"step": [1], "valid": [2.5]}), PARAMS.pairs, PARAMS.verdict, CLASSICAL
    )
    names = {path.name for path in (tmp_path / "flow").iterdir()}
    assert names == {weights.WEIGHTS, flow_verdict.CURVE, flow_verdict.PICTURE, flow_verdict.VERDICT}
    errors = results.load_json(tmp_path / "flow" / flow_verdict.VERDICT)
    assert set(errors) == {"corrflow", "zero", "dis", "farneback"}
    assert all(set(each) == {"overall_px", "inside_px"} for each in errors.values())
    again = weights.load(tmp_path / "flow").state_dict()
    assert all(torch.equal(value, again[name]) for name, value in net.state_dict().items())


def test_the_sheet_shows_both_frames_and_both_flows():
    flows = [pair.flow for pair in PAIRS]
    picture = sheet(PAIRS[:2], flows, 6)
    assert picture.shape == (64, 128, 3)
    np.testing.assert_array_equal(picture[:, 64:96], picture[:, 96:])
    np.testing.assert_array_equal(picture[32:, :32], PAIRS[1].frames[0])
