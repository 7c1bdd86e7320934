"""The command that is named as the mend makes what is missing, for sets inside and outside of `run.datasets`."""

import shlex
from pathlib import Path

import pytest
import yaml
from dvc.cli import parse_args

from physpipe.commands.making import alone, made, running
from physpipe.core.errors import InputError

TABLE = Path("data/tracks/x.parquet")


def mend(name: str, stage: str = "") -> str:
    with pytest.raises(InputError, match="no such file") as caught:
        made(TABLE, name, stage)
    return caught.value.mend


def test_what_is_there_needs_no_command(project):
    TABLE.parent.mkdir(parents=True)
    TABLE.touch()
    assert made(TABLE, "pendulum") == TABLE


def test_sets_of_the_run_are_made_by_repro(project):
    assert "bowls" in yaml.safe_load(Path("params.yaml").read_text())["run"]["datasets"]
    assert mend("bowls") == "run `dvc repro`, which makes it"
    assert mend("bowls", "ingest") == "run `dvc repro ingest@bowls`, which makes it"


def test_others_are_run_alone_after_their_film_came(project):
    command = 'dvc exp run -S "run.datasets=[pendulum]" -S "run.simulated=[]" -S "run.supervised=[]"'
    assert mend("pendulum") == f"run `physpipe add pendulum FOLDER`, then `{command}`, which makes it"
    Path("data/raw").mkdir(parents=True)
    Path("data/raw/pendulum.dvc").touch()
    assert mend("pendulum") == f"run `{command}`, which makes it"
    assert mend("pendulum", "ingest") == f"run `{command} ingest@pendulum`, which makes it"


def test_simulated_sets_are_simulated_for_it(project):
    words = 'dvc exp run -S "run.datasets=[heights]" -S "run.simulated=[heights]" -S "run.supervised=[heights]"'
    assert (alone("heights"), running("heights")) == (words, words)


def test_dvc_understands_it(project):
    asked = parse_args(shlex.split(running("pendulum", "ingest"))[1:])
    assert asked.set_param == ["run.datasets=[pendulum]", "run.simulated=[]", "run.supervised=[]"]
    assert asked.targets == ["ingest@pendulum"]


def test_nothing_makes_a_file_outside_the_data(project):
    with pytest.raises(InputError) as caught:
        made(Path("mine.parquet"), "bowls")
    assert caught.value.mend == "give one that is there"
