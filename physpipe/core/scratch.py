"""Where work that may be thrown away is kept between runs."""

import os
from pathlib import Path


def scratch_root() -> Path:
    """`PHYSPIPE_SCRATCH`, else `.scratch` of the project; Git and DVC ignore it."""
    return Path(os.environ.get("PHYSPIPE_SCRATCH") or ".scratch")
