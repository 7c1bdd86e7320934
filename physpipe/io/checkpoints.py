"""Model weights, and the checkpoints that let a killed training go on."""

import hashlib
import io
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import torch
from pydantic import BaseModel

from physpipe.core.errors import InputError
from physpipe.core.scratch import scratch_root
from physpipe.io.atomic import replacing


def save(path: Path, state: dict[str, Any]) -> None:
    """Writes tensors and plain values atomically; the same values give the same bytes."""
    buffer = io.BytesIO()  # a file's own name would go into its bytes
    torch.save(state, buffer)
    with replacing(path) as temporary:
        temporary.write_bytes(buffer.getvalue())


def load(path: Path) -> dict[str, Any]:
    """Reads onto the CPU; raises InputError when the file is absent or no checkpoint of ours."""
    if not path.is_file():
        raise InputError(path, "no such file", "run `dvc repro`, which makes it")
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:
        raise InputError(path, f"cannot be read as weights ({error})", "remove it and run `dvc repro`") from None


def load_into(model: torch.nn.Module, weights: dict[str, Any], path: Path) -> None:
    """Puts `weights` into `model`; raises InputError when a shape or a name differs."""
    try:
        model.load_state_dict(weights)
    except RuntimeError as error:
        raise InputError(path, f"weights of another model ({error})", "run `dvc repro` to train it again") from None


def scratch(stage: str, params: Iterable[BaseModel], inputs: Iterable[Path]) -> Path:
    """Folder for a stage's checkpoints, keyed by all that decides its result: code, params and input bytes.

    A run with other params or data thus never goes on from these. Git and DVC ignore it.
    """
    digest = hashlib.sha256(stage.encode())
    for each in params:
        digest.update(each.model_dump_json().encode())
    package = Path(__file__).resolve().parents[1]
    for path in [*sorted(package.rglob("*.py")), *(file for each in inputs for file in _files(each))]:
        digest.update(path.name.encode() + hashlib.sha256(path.read_bytes()).digest())
    return scratch_root() / stage / digest.hexdigest()[:16]


def _files(path: Path) -> list[Path]:
    return sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]


def forget(folder: Path) -> None:
    """Removes a stage's checkpoints once its result is written."""
    shutil.rmtree(folder, ignore_errors=True)
