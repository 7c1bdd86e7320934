"""sRGB to CIE LAB, where equal distances look about equally different."""

import cv2
import numpy as np
from numpy.typing import NDArray

_CODE = np.arange(256) / 255
_LINEAR = np.where(_CODE <= 0.04045, _CODE / 12.92, ((_CODE + 0.055) / 1.055) ** 2.4).astype(np.float32)
"""Linear light of each sRGB code value (IEC 61966-2-1)."""


def srgb_to_lab(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """(..., 3) sRGB to (..., 3) CIE LAB under D65: white is (100, 0, 0), black (0, 0, 0)."""
    # OpenCV's own sRGB curve is interpolated and tints greys; from linear light its LAB is exact.
    light = _LINEAR[np.ascontiguousarray(rgb).reshape(-1, 1, 3)]
    lab: NDArray[np.float32] = np.asarray(cv2.cvtColor(light, cv2.COLOR_LRGB2Lab), np.float32)
    return lab.reshape(rgb.shape)
