"""The section of params.yaml that a new data set gets."""

from collections.abc import Iterator
from typing import Any

import yaml
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.core.params import PARAMS, Section, read
from physpipe.exporting.scale import ScaleParams
from physpipe.health.sections import OF_A_SET
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
    """params.yaml's text with the new section; raises InputError for values that a stage or a command would refuse."""
    result = params_file.with_section(text, "datasets", TEMPLATE, name, changes)
    faults = list(_faults(f"datasets.{name}", yaml.safe_load(result)["datasets"][name]))
    if faults:
        mend = "correct the options" if changes else "correct the section"
        raise InputError(PARAMS, f"these values would be refused: {'; '.join(faults)}", mend)
    return result


def _faults(where: str, section: dict[str, Any]) -> Iterator[str]:
    kinds: dict[str, type[Section]] = {**OF_A_SET, "scale": ScaleParams}
    for part, kind in kinds.items():
        if part == "scale" and part not in section:  # the one that may be left out
            continue
        try:
            kind.model_validate(section.get(part))
        except ValidationError as error:
            for each in error.errors():
                yield f"`{'.'.join(map(str, [where, part, *each['loc']]))}`: {each['msg']}"


def block(name: str, changes: dict[str, Any]) -> str:
    """The new section alone, as it would stand in params.yaml."""
    before = PARAMS.read_text(encoding="utf-8")
    lines = extended(before, name, changes).splitlines()
    start = lines.index(f"  {name}:")
    return "\n".join(lines[start : start + len(lines) - len(before.rstrip().splitlines())])
