"""params.yaml is read strictly: no defaults, no unknown keys, typed values, every mistake with its mend."""

from pathlib import Path

import pytest
from pydantic import Field, ValidationError

from physpipe.core import params
from physpipe.core.errors import InputError


class StepParams(params.Section):
    """A nested section."""

    size: float = Field(gt=0)
    """Any positive number."""


class RunParams(params.Section):
    """A section."""

    rate: float
    """Any number."""
    count: int
    """Any whole number."""
    step: StepParams
    """Nested."""


GOOD = "learn:\n  run:\n    rate: 1.5\n    count: 3\n    step:\n      size: 2\nnames:\n- a\n- b\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "params.yaml").write_text(GOOD)
    return tmp_path / "params.yaml"


def refusal(path: Path, text: str, section: str = "learn.run") -> str:
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        params.read(section, RunParams, path)
    assert caught.value.where == str(path)
    return caught.value.reason


def test_a_section_becomes_typed_and_frozen(path: Path) -> None:
    read = params.read("learn.run", RunParams, path)
    assert read == RunParams(rate=1.5, count=3, step=StepParams(size=2.0))
    with pytest.raises(ValidationError):
        read.rate = 2.0  # type: ignore[misc]


def test_numbers_that_yaml_reads_as_words_are_numbers(path: Path) -> None:
    path.write_text(GOOD.replace("1.5", "1e-05"))  # PyYAML reads 1e-05 as a string
    assert params.read("learn.run", RunParams, path).rate == 1e-5


def test_a_misspelt_key_is_refused_with_the_nearest_one(path: Path) -> None:
    assert "did you mean `rate`?" in refusal(path, GOOD.replace("rate: 1.5", "rate: 1.5\n    rat: 2"))
    assert "did you mean `size`?" in refusal(path, GOOD.replace("size: 2", "size: 2\n      sise: 2"))


def test_every_mistake_is_named_at_once(path: Path) -> None:
    reason = refusal(path, GOOD.replace("rate: 1.5", "rate: fast").replace("count: 3", "count: 3.5"))
    assert "`learn.run.rate`" in reason
    assert "'fast'" in reason
    assert "`learn.run.count`" in reason


@pytest.mark.parametrize("value", ["-1", "0", ".inf", ".nan", "null"])
def test_values_outside_the_legal_range_are_refused(path: Path, value: str) -> None:
    assert "`learn.run.step.size`" in refusal(path, GOOD.replace("size: 2", f"size: {value}"))


def test_a_missing_key_is_refused(path: Path) -> None:
    assert "`learn.run.count`" in refusal(path, GOOD.replace("    count: 3\n", ""))


def test_a_missing_section_names_the_part_that_is_missing(path: Path) -> None:
    assert "no key `learn.runs` (did you mean `run`?)" in refusal(path, GOOD, "learn.runs")
    assert "no key `lean` (did you mean `learn`?)" in refusal(path, GOOD, "lean.run")


def test_files_that_are_absent_or_no_yaml_are_refused(path: Path) -> None:
    assert "not valid YAML" in refusal(path, "a: [1, 2\nb")
    path.unlink()
    with pytest.raises(InputError, match="no such file"):
        params.read("learn.run", RunParams, path)


def test_bare_values_come_as_they_are(path: Path) -> None:
    assert params.read_value("names", path) == ["a", "b"]
    assert params.read_value("learn.run.count", path) == 3


def test_an_experiments_copy_may_not_run_another_copys_library(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DVC_ROOT", str(path.parent))
    with pytest.raises(InputError, match="the library lies outside"):
        params.read("learn.run", RunParams, path)
    with pytest.raises(InputError, match="the library lies outside"):
        params.read_value("names", path)
