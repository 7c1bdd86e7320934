"""The stage, end to end, on files alone."""

import json
from dataclasses import astuple
from pathlib import Path

import pytest
import yaml

from physpipe.core.errors import InputError
from stages.report import main


def write_params(project, folder, **run) -> None:
    compute = {"seed": 7, "threads": 1}
    sections = {"run": {**project.run.model_dump(), **run}, "report": project.shown.model_dump(), "compute": compute}
    sections |= {"tracker": {"lock": project.lock.model_dump()}}
    (folder / "params.yaml").write_text(yaml.safe_dump(sections))


def ablation(folder: Path) -> Path:
    """The file as it is before `make ablation` has run."""
    (folder / "ablation.json").write_text("{}\n")
    return folder / "ablation.json"


def test_stage_writes_metrics_and_page(project, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_params(project, tmp_path)
    main(*astuple(project.sources), ablation(tmp_path), tmp_path / "metrics", tmp_path / "report")
    assert {path.name for path in (tmp_path / "report").iterdir()} == {"index.html"}
    assert "Not measured yet" in (tmp_path / "report" / "index.html").read_text()
    assert {path.suffix for path in (tmp_path / "metrics").iterdir()} == {".json", ".csv"}
    assert json.loads((tmp_path / "metrics" / "summary.json").read_text())["locked"] is False


def test_a_predictor_of_another_run_is_refused(project, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_params(project, tmp_path, learned=["probnet"])  # forecasts of dispnet still lie about
    with pytest.raises(InputError, match="`dispnet` does not run"):
        main(*astuple(project.sources), ablation(tmp_path), tmp_path / "metrics", tmp_path / "report")


def test_a_failed_stage_leaves_no_page(project, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_params(project, tmp_path, datasets=["bowls", "nowhere"])
    with pytest.raises(InputError, match="nowhere"):
        main(*astuple(project.sources), ablation(tmp_path), tmp_path / "metrics", tmp_path / "report")
    assert not (tmp_path / "report").exists()
    assert not (tmp_path / "metrics").exists()


def test_a_missing_ablation_is_named(project, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_params(project, tmp_path)
    with pytest.raises(InputError, match=r"ablation\.json"):
        main(*astuple(project.sources), tmp_path / "ablation.json", tmp_path / "metrics", tmp_path / "report")
    assert not (tmp_path / "report").exists()
