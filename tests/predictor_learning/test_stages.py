"""The stages, end to end, on files alone."""

from pathlib import Path

import pytest
import yaml

from physpipe.core.errors import InputError
from physpipe.io import forecasts, tracks
from physpipe.predictor_learning.predicting import load_predictor
from stages import forecast, train_predictor

ROOT = Path(__file__).parents[2]
HORIZON, END = 6, 12


@pytest.fixture
def project(tmp_path, monkeypatch, falling_balls):
    """A folder with clips and tracks of a set `balls`, and the project's own predictors, trained for two steps."""
    monkeypatch.chdir(tmp_path)
    found, table = falling_balls()
    tracks.save(tmp_path / "tracks.parquet", table, "test", found)
    predictors = yaml.safe_load((ROOT / "params.yaml").read_text())["predictors"]
    for section in predictors.values():
        section["fit"] |= {"steps": 2, "valid_every": 1, "batch_size": 2}
        section["windows"]["valid_windows"] = 2
    params = {
        "compute": {"seed": 0, "threads": 1},
        "datasets": {"balls": {"predict": {"horizon": HORIZON, "interpolation": END, "mirrors": True}}},
        "predictors": predictors,
    }
    Path("params.yaml").write_text(yaml.safe_dump(params))
    return params


def run(name: str) -> Path:
    """The forecasts of a predictor that has just been trained."""
    train_predictor.main("balls", name, Path("set"), Path("tracks.parquet"), Path("model"))
    out = Path("forecasts.parquet")
    forecast.main("balls", name, Path("set"), Path("tracks.parquet"), Path("model"), out)
    return out


@pytest.mark.parametrize(
    ("name", "last"), [("dispnet_long", 4 * HORIZON), ("probnet", 4 * HORIZON), ("interpnet", END)]
)
def test_a_section_is_trained_as_its_kind_and_forecast_as_far_as_it_goes(project, name, last):
    table = forecasts.load(run(name))
    assert table.loc[table["clip"] == "c3", "frame"].agg(["min", "max"]).tolist() == [4, last]
    assert ("cov_xx" in table) == (name != "interpnet")


def test_a_set_without_interpolation_refuses_what_is_trained_to_it(project):
    project["datasets"]["balls"]["predict"]["interpolation"] = None
    Path("params.yaml").write_text(yaml.safe_dump(project))
    with pytest.raises(InputError, match=r"`datasets\.balls\.predict\.interpolation`: is empty"):
        run("interpnet")


@pytest.mark.parametrize("mirrors", [True, False])
def test_a_forecast_is_a_mean_over_mirrors_only_where_film_could_be_mirrored(project, mirrors):
    assert project["predictors"]["dispnet"]["model"]["symmetric"]
    project["datasets"]["balls"]["predict"]["mirrors"] = mirrors
    Path("params.yaml").write_text(yaml.safe_dump(project))
    run("dispnet")
    assert load_predictor(Path("model"), "dispnet", 1).symmetric is mirrors
