"""Names of the baselines and what they are built from."""

import pickle

import pytest
from pydantic import ValidationError

from physpipe.baselines.template import TemplateParams
from physpipe.baselines.zoo import BASELINES, BaselineParams, Follower, Settings, known_flows
from physpipe.core.errors import InputError

TEMPLATE = TemplateParams(candidates=4, flat_lab=2, smoothness_per_px2=0.001, lost_score=0.4, lost_switch=1)
NEEDS_A_NETWORK = {"flow_simple", "flow_blob"}


def test_an_unknown_baseline_is_refused(params: BaselineParams) -> None:
    with pytest.raises(ValidationError, match="flownet"):
        BaselineParams.model_validate(params.model_dump() | {"names": ["lab", "flownet"]})


def test_by_default_all_run_that_need_no_training(params: BaselineParams) -> None:
    assert set(params.names) == set(BASELINES) - NEEDS_A_NETWORK
    assert len(params.names) == len(set(params.names))


@pytest.mark.parametrize("name", sorted(NEEDS_A_NETWORK))
def test_the_learned_flow_is_asked_for_by_name(name: str, params: BaselineParams) -> None:
    baseline, flows = BASELINES[name], known_flows(params)
    assert isinstance(baseline, Follower)
    with pytest.raises(InputError, match="flow network"):
        baseline.build(Settings(params, TEMPLATE, 5.0, flows), [])
    baseline.build(Settings(params, TEMPLATE, 5.0, flows | {"flow": flows["dis"]}), [])


def test_settings_cross_to_other_processes(params: BaselineParams) -> None:
    settings = Settings(params, TEMPLATE, 5.0, known_flows(params))
    assert pickle.loads(pickle.dumps(settings)).params == params
