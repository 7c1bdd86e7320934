"""Other programs, asked by their command: the library imports neither Git nor DVC."""

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from physpipe.core.errors import InputError

Ask = Callable[..., str]
"""Words of a command line to what it prints; raises InputError when it is absent or fails."""


def ask(*words: str) -> str:
    """Runs a command, the one installed beside this Python before any other."""
    beside = str(Path(sys.executable).parent)
    program = shutil.which(words[0], path=beside) or shutil.which(words[0])
    if program is None:
        raise InputError(words[0], "not found", f"install it: {INSTALL[words[0]]}")
    done = subprocess.run([program, *words[1:]], capture_output=True, text=True, encoding="utf-8", errors="replace")
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip() or "no word").splitlines()[-1]
        raise InputError(" ".join(words), f"failed ({said})", "run it by hand to see more")
    return done.stdout


INSTALL = {"dvc": "pip install -e '.[pipeline]', or make setup", "git": "from git-scm.com or your package manager"}
