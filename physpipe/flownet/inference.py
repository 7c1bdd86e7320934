"""Flow between frames as they come from film."""

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray

from physpipe.core.determinism import device
from physpipe.core.images import as_images
from physpipe.core.precision import brief
from physpipe.flownet.network import CorrFlow


@torch.no_grad()
def flows(
    net: CorrFlow, first: NDArray[np.uint8], second: NDArray[np.uint8], batch_pairs: int
) -> Iterator[NDArray[np.float32]]:
    """(H, W, 2) pixels (x, y) from each of `first` (N, H, W, 3) to the same of `second`, `batch_pairs` at a time."""
    net = net.to(device(), memory_format=torch.channels_last).eval()  # type: ignore[call-overload]
    for start in range(0, len(first), batch_pairs):
        pictures = [as_images(np.array(each[start : start + batch_pairs])) for each in (first, second)]
        with brief():
            found = net(*pictures)
        yield from found.float().movedim(1, -1).contiguous().cpu().numpy()
