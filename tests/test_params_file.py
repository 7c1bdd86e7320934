"""Facts about the project's own params.yaml."""

from pathlib import Path

import pytest
import torch
import yaml
from dvc.utils.hydra import apply_overrides

from physpipe.core.ball import BallParams
from physpipe.core.determinism import ComputeParams, torch_generator
from physpipe.core.horizon import PredictParams
from physpipe.core.objects import ObjectsParams
from physpipe.core.params import read, read_value
from physpipe.exporting.scale import ScaleParams
from physpipe.finetuning.tuning import FinetuneParams
from physpipe.flow_learning.film import as_batch, draw_pairs
from physpipe.flow_learning.flow import FlowParams
from physpipe.flownet.network import CorrFlow
from physpipe.ingest.dataset import IngestParams
from physpipe.predictor_learning.predicting import learned_params, predictor_class
from physpipe.predictors.base import Seen, Window
from physpipe.report.params import ReportParams
from physpipe.report.run import RunParams
from physpipe.scenes.presets import PresetsParams, SimulateParams
from physpipe.tracker_learning.recipe import TrackerParams
from physpipe.tracknet.model import TrackNet
from physpipe.tracknet.moments import Moments

PATH = Path(__file__).parents[1] / "params.yaml"
PARAMS = yaml.safe_load(PATH.read_text())
RECIPES = list(PARAMS["tracker"]["recipes"])


@pytest.mark.parametrize("name", list(PARAMS["datasets"]))
def test_every_data_set_has_all_its_sections(name):
    kinds = {"ingest": IngestParams, "motion": ObjectsParams, "evaluate": BallParams, "predict": PredictParams}
    kinds |= {"simulate": SimulateParams} if "simulate" in PARAMS["datasets"][name] else {"scale": ScaleParams}
    assert set(PARAMS["datasets"][name]) == set(kinds)
    for section, kind in kinds.items():
        read(f"datasets.{name}.{section}", kind, PATH)


@pytest.mark.parametrize("name", [name for name in PARAMS["datasets"] if "simulate" in PARAMS["datasets"][name]])
def test_every_simulated_set_names_presets_that_exist_in_each_of_its_sizes(name):
    simulated = read(f"datasets.{name}.simulate", SimulateParams, PATH)
    for size in simulated.sizes:
        world = simulated.model_copy(update={"size": size}).world(read("presets", PresetsParams, PATH), name)
        assert world.balls.count == read(f"datasets.{name}.motion", ObjectsParams, PATH).objects


def test_what_runs_and_how_it_is_tuned_is_told():
    read("run", RunParams, PATH)
    read("finetune", FinetuneParams, PATH)


@pytest.mark.parametrize("name", list(PARAMS["predictors"]))
def test_every_predictor_s_section_builds_one_that_takes_a_step(name):
    kind = predictor_class(read_value(f"predictors.{name}.kind", PATH))
    predictor = kind(read(f"predictors.{name}", learned_params(kind), PATH).model, 1)
    assert sum(each.numel() for each in predictor.parameters()) <= 1_000_000
    film = torch.rand(2, kind.seen_frames + kind.sees_end, 3, 64, 64, generator=torch_generator(0))
    times = torch.arange(kind.seen_frames + 2.0).expand(2, -1)
    seen_times = times[:, [*range(kind.seen_frames), *([-1] if kind.sees_end else [])]]
    track = torch.full((2, kind.seen_frames + 2, 1, 2), 30.0)
    seen = Seen(film, track[:, :-2], seen_times)
    batch = Window(seen, times[:, -2:], track[:, -2:], 80.0, track)
    loss, _ = predictor.loss(batch, torch_generator(1))
    loss.backward()
    assert torch.isfinite(loss)


def test_only_sets_of_short_film_have_no_interpolation():
    reach = {name: read(f"datasets.{name}.predict", PredictParams, PATH) for name in PARAMS["datasets"]}
    assert {name for name, each in reach.items() if each.interpolation is None} == {"pendulum", "tray", "bounce"}
    assert all(each.interpolation == 2 * each.horizon for each in reach.values() if each.interpolation)


def test_every_preset_is_used():
    named = [each["simulate"] for each in PARAMS["datasets"].values() if "simulate" in each]
    for plural, key in {"terrains": "terrain", "palettes": "palette", "looks": "look", "cameras": "camera"}.items():
        assert set(PARAMS["presets"][plural]) == {each[key] for each in named}
    assert set(PARAMS["presets"]["physics"]) == {each["physics"] for each in named}


def test_simulated_sets_are_exactly_those_with_a_simulate_section():
    simulated = set(read_value("run.simulated", PATH))
    assert {name for name in read_value("run.datasets", PATH) if "simulate" in PARAMS["datasets"][name]} == simulated


def test_what_runs_by_default_needs_no_film_of_the_user():
    run = read("run", RunParams, PATH)
    assert set(run.datasets) == set(run.simulated)
    assert set(run.supervised) <= set(run.datasets)
    read("report", ReportParams, PATH)
    read("compute", ComputeParams, PATH)


@pytest.mark.parametrize("recipe", RECIPES)
def test_every_recipe_of_the_tracker_takes_a_step(recipe):
    params = read("tracker", TrackerParams, PATH).model_copy(update={"recipe": recipe}).chosen()
    net = TrackNet(params.net, frame_size=56)
    net.steps += params.net.warm_start_steps
    film = torch.rand(2, 5, 3, 40, 56, generator=torch_generator(0))
    loss, parts = net.loss(Moments(film, film.mean(1)), torch_generator(1))
    loss.backward()
    assert torch.isfinite(loss)
    assert {"order_nats", "entropy_nats", "siamese_px2"} <= set(parts)


@pytest.mark.parametrize("name", list(PARAMS["flow"]))
def test_every_flow_network_is_small_and_takes_a_step(name):
    params = read(f"flow.{name}", FlowParams, PATH)
    net = CorrFlow(params.network)
    assert sum(each.numel() for each in net.parameters()) <= 1_000_000
    loss, _ = net.loss(as_batch(draw_pairs(params.pairs, 1, torch_generator(0))), torch_generator(1))
    loss.backward()
    assert torch.isfinite(loss)


def test_the_plain_recipe_is_the_paper_s():
    net = read("tracker", TrackerParams, PATH).recipes["paper"].net
    assert (net.losses.causality, net.losses.entropy, net.losses.equivariance) == (1, 0.01, 0.001)
    assert (net.negatives, net.bottleneck.end_px, net.flicker, net.warm_start_steps) == (0, 0, 0, 0)
    assert not net.mirrored
    assert not net.discriminator.shape_only


def test_the_file_is_in_block_style_so_that_an_override_changes_one_line():
    lines = PATH.read_text().splitlines()
    assert [line for line in lines if len(line) > 80] == []
    values = [line.split("#")[0].rstrip() for line in lines]
    assert [each for each in values if each.endswith(("}", "]")) and not each.endswith("[]")] == []  # [] has no block


@pytest.mark.parametrize("emptied", ["simulated", "learned", "supervised"])
def test_a_list_of_what_runs_can_be_emptied_by_an_override(emptied, tmp_path):
    copy = tmp_path / "params.yaml"
    copy.write_text(PATH.read_text())
    apply_overrides(copy, [f"run.{emptied}=[]", "run.datasets=[bowls]"])
    expected = {**PARAMS, "run": {**PARAMS["run"], emptied: [], "datasets": ["bowls"]}}
    assert yaml.safe_load(copy.read_text()) == expected
    assert copy.read_text().count("#") == PATH.read_text().count("#")
