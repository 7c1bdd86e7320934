"""The section of params.yaml that a new data set gets."""

from typing import Any

import yaml
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS, read
from physpipe.exporting.scale import ScaleParams
from physpipe.ingest.dataset import IngestParams
from physpipe.io import params_file

TEMPLATE = "pendulum"
"""The set whose section is copied."""


def template() -> IngestParams:
    """How the template is ingested; raises InputError outside a project."""
    return read(f"datasets.{TEMPLATE}.ingest", IngestParams)


def exists(name: str) -> bool:
    """Whether params.yaml has a section of that name already."""
    return name in yaml.safe_load(PARAMS.read_text(encoding="utf-8"))["datasets"]


def extended(text: str, name: str, changes: dict[str, Any]) -> str:
    """params.yaml's text with the new section; raises InputError for values that ingest would refuse."""
    result = params_file.with_section(text, "datasets", TEMPLATE, name, changes)
    try:
        section = yaml.safe_load(result)["datasets"][name]
        IngestParams.model_validate(section["ingest"])
        ScaleParams.model_validate(section.get("scale") or {"pixels_per_metre": None})
    except ValidationError as error:
        faults = [f"`{'.'.join(map(str, each['loc']))}`: {each['msg']}" for each in error.errors()]
        raise InputError(PARAMS, f"these values would be refused: {'; '.join(faults)}", "correct the options") from None
    return result


def block(name: str, changes: dict[str, Any]) -> str:
    """The new section alone, as it would stand in params.yaml."""
    before = PARAMS.read_text(encoding="utf-8")
    lines = extended(before, name, changes).splitlines()
    start = lines.index(f"  {name}:")
    return "\n".join(lines[start : start + len(lines) - len(before.rstrip().splitlines())])
