"""PNG files."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from physpipe.io.atomic import replacing


def save_png(path: Path, image: NDArray[np.uint8]) -> None:
    """Writes an (H, W, 3) RGB picture."""
    done, data = cv2.imencode(".png", cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
    if not done:
        raise OSError(f"{path}: the picture of shape {image.shape} cannot be encoded")
    with replacing(path) as temporary:
        temporary.write_bytes(data.tobytes())
