"""Pictures as text inside the page."""

import base64

import cv2
import numpy as np
from numpy.typing import NDArray


def embedded(kind: str, content: bytes) -> str:
    """`content` of the media type `kind` as an address that needs no other file."""
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def webp(picture: NDArray[np.uint8], quality: int) -> str:
    """(H, W, 3) RGB as an embedded WebP picture; `quality` from 1 to 100."""
    done, coded = cv2.imencode(".webp", picture[:, :, ::-1], [cv2.IMWRITE_WEBP_QUALITY, quality])
    if not done:
        raise OSError(f"a picture of shape {picture.shape} cannot be encoded")
    return embedded("image/webp", coded.tobytes())
