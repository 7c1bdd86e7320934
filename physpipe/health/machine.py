"""Python, libraries, cores, graphics card, disk."""

import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from physpipe.core.parallel import worker_count
from physpipe.core.scratch import scratch_root
from physpipe.health.finding import Finding, Level

OLDEST = (3, 11)
LIBRARIES = ("numpy", "scipy", "pandas", "pyarrow", "opencv-python-headless", "av", "matplotlib", "mujoco", "pydantic")
OPENCV = "opencv-python-headless"
RIVALS = ("opencv-python", "opencv-contrib-python", "opencv-contrib-python-headless")
"""They overwrite each other's files."""
INSTALL = "install the project again: pip install -e '.[dev]', or make setup"
LITTLE_GB, TOO_LITTLE_GB = 5.0, 1.0
BUSY = 1.5
"""Waiting programs a core."""


def check() -> Iterator[Finding]:
    """Everything about the machine."""
    yield _python()
    yield from _libraries()
    yield from _torch()
    yield from _codecs()
    yield _cores()
    yield from _disks()


def _python() -> Finding:
    text = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}, {sys.prefix}"
    if sys.version_info < OLDEST:
        return Finding("problem", text, f"use Python {'.'.join(map(str, OLDEST))} or newer")
    return Finding("ok", text)


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _libraries() -> Iterator[Finding]:
    found = {name: _version(name) for name in LIBRARIES}
    yield Finding("ok", ", ".join(f"{name} {version}" for name, version in found.items() if version))
    missing = [name for name, version in found.items() if version is None]
    if missing:
        yield Finding("problem", f"not installed: {', '.join(missing)}", INSTALL)
    rivals = [name for name in RIVALS if _version(name)]
    if rivals:
        mend = f"pip uninstall {' '.join([*rivals, OPENCV])}, then pip install {OPENCV}"
        yield Finding("problem", f"{', '.join(rivals)} beside {OPENCV}: they overwrite each other", mend)


def _torch() -> Iterator[Finding]:
    try:
        import torch  # here, since a check-up must survive an installation that is broken

        from physpipe.core.precision import has_bfloat16
    except Exception as error:
        yield Finding("problem", f"PyTorch cannot be imported ({error})", INSTALL)
        return
    numbers = "bfloat16" if has_bfloat16() else "float32: no bfloat16 here, so figures differ from those made with it"
    yield Finding("ok", f"torch {torch.__version__}; most networks compute in {numbers}")
    if torch.cuda.is_available():
        card = torch.cuda.get_device_properties(0)
        yield Finding("ok", f"GPU: {card.name}, {card.total_memory / 1e9:.0f} GB; training uses it")
    elif shutil.which("nvidia-smi"):
        text = f"there is an NVIDIA driver, but PyTorch {torch.__version__} cannot use the card"
        yield Finding("warning", text, "install the PyTorch build of your CUDA version into this environment")
    else:
        yield Finding("ok", "GPU: none that PyTorch can use; training runs on the CPU")


def _codecs() -> Iterator[Finding]:
    try:
        import av  # here for the same reason
    except Exception as error:
        yield Finding("problem", f"PyAV cannot be imported ({error})", INSTALL)
        return
    names = ("libavcodec", "libavformat", "libswscale")
    versions = ", ".join(f"{name} {'.'.join(map(str, av.library_versions[name]))}" for name in names)
    yield Finding("ok", f"FFmpeg in PyAV: {versions}")
    if "libx264" not in av.codecs_available:
        yield Finding("problem", "this FFmpeg cannot write H.264", "pip install --force-reinstall av")


def _cores() -> Finding:
    text = f"{worker_count()} of {os.cpu_count()} cores are for us (PHYSPIPE_WORKERS)"
    waiting = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0  # Windows does not count
    if waiting > BUSY * (os.cpu_count() or 1):
        return Finding("warning", f"{text}; {waiting:.0f} programs want one: trainings will crawl", "wait, or end some")
    return Finding("ok", text)


def _disks() -> Iterator[Finding]:
    for what, folder in (("project", Path()), ("scratch", scratch_root()), ("temporary", Path(tempfile.gettempdir()))):
        here = next(each for each in (folder.resolve(), *folder.resolve().parents) if each.exists())
        free = shutil.disk_usage(here).free / 1e9
        level: Level = "problem" if free < TOO_LITTLE_GB else "warning" if free < LITTLE_GB else "ok"
        mend = "" if level == "ok" else "free some space; `dvc gc --workspace` drops results of other runs"
        yield Finding(level, f"{free:.1f} GB free for {what} files ({here})", mend)
