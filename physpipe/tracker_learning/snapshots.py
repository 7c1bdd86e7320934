"""Heat maps as a picture: does the detector look where the object is?"""

from collections.abc import Sequence

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from physpipe.core.determinism import device
from physpipe.core.images import as_images
from physpipe.io.clips import ClipSet
from physpipe.tracknet.model import TrackNet

ROWS = 5
GAP = 4


@torch.no_grad()
def heat_sheet(clips: ClipSet, nets: Sequence[TrackNet]) -> NDArray[np.uint8]:
    """(H', W', 3) RGB sheet: a row a validation frame, first the frame, then each network's heat map over it."""
    names = clips.names("valid")
    chosen = [names[number] for number in np.linspace(0, len(names) - 1, ROWS).astype(int)]
    frames = np.stack([clips.frames(name)[len(clips.frames(name)) // 2] for name in chosen])
    columns = [frames, *(_overlays(frames, net) for net in nets)]
    padded = [np.pad(each, ((0, 0), (0, GAP), (0, GAP), (0, 0)), constant_values=255) for each in columns]
    return np.concatenate([np.concatenate(list(column)) for column in padded], axis=1)


def _overlays(frames: NDArray[np.uint8], net: TrackNet) -> NDArray[np.uint8]:
    net = net.to(device()).eval()
    heat = net.detector.heat(as_images(frames)).cpu().numpy()
    return np.stack([_overlay(frame, each) for frame, each in zip(frames, heat, strict=True)])


def _overlay(frame: NDArray[np.uint8], heat: NDArray[np.float32]) -> NDArray[np.uint8]:
    bright = (255 * np.sqrt(heat / heat.max())).astype(np.uint8)  # the root shows faint second peaks
    bright = cv2.resize(bright, frame.shape[1::-1], interpolation=cv2.INTER_NEAREST)
    coloured = cv2.cvtColor(cv2.applyColorMap(bright, cv2.COLORMAP_INFERNO), cv2.COLOR_BGR2RGB)
    return np.asarray(cv2.addWeighted(frame, 0.4, coloured, 0.6, 0), np.uint8)
