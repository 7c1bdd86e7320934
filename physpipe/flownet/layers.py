"""Parts of the flow network: contrast, features, and one level of the way from coarse to fine."""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from physpipe.flownet.matching import correlation, enlarged, likeliest_offset, warp

SLOPE = 0.1  # of the rectifiers below 0
FAINTEST = 0.01  # contrast, of 1, below which all is sensor noise
SHARPNESS = 10.0  # of the softmax over matches before any training; a match of a cell with itself is about 1


def contrast(pictures: Tensor, window: int) -> Tensor:
    """(B, 3, H, W) deviation of each pixel from its surroundings, in units of theirs.

    Drifting light then is no motion, and a bright ball or a steep slope does not drown faint texture.
    """
    apart = pictures - _mean_around(pictures, window)
    spread = _mean_around(apart.square().mean(1, keepdim=True), window).sqrt()
    return apart / (spread + FAINTEST)


def _mean_around(pictures: Tensor, window: int) -> Tensor:
    """Box mean over the part of the window that lies in the picture."""
    for size in ((window, 1), (1, window)):
        margin = (size[0] // 2, size[1] // 2)
        pictures = F.avg_pool2d(pictures, size, 1, margin, count_include_pad=False)
    return pictures


def features(inputs: int, outputs: int) -> nn.Sequential:
    """Half the resolution. Each channel ends with mean 0 and variance 1, so that even ground differs from nothing."""
    last = nn.Conv2d(outputs, outputs, 3, padding=1)
    return nn.Sequential(_layer(inputs, outputs, stride=2), last, nn.InstanceNorm2d(outputs))


class Level(nn.Module):
    """Corrects the coarser level's flow by matches around the place that it points to."""

    def __init__(self, channels: int, radius: int, width: int, coarser: int):
        super().__init__()
        self.radius = radius
        inputs = (2 * radius + 1) ** 2 + 2 * channels + 2 + (coarser + 2 if coarser else 0)
        self.sharpness = nn.Parameter(torch.tensor(SHARPNESS))
        self.look = _layer(inputs, width)
        self.agree = nn.Conv2d(width, width, 1)
        self.read = nn.Sequential(_layer(width, width), _layer(width, width))
        self.correct = nn.Conv2d(width, 3, 3, padding=1)
        for each in self.correct.parameters():
            nn.init.zeros_(each)

    def forward(
        self, first: Tensor, second: Tensor, flow: Tensor | None, state: Tensor | None, stride: int
    ) -> tuple[Tensor, Tensor]:
        """Flow (B, 2, h, w) in pixels and state (B, width, h, w) from the coarser level's (none at the coarsest)."""
        if flow is None or state is None:
            flow, known = first.new_zeros(()), []
        else:
            flow = enlarged(flow, 2)
            second, known = warp(second, flow / stride), [flow / stride, enlarged(state, 2)]
        matches = correlation(first, second, self.radius)
        offset = likeliest_offset(matches, self.sharpness)
        seen = self.look(torch.cat([matches, first, second - first, offset, *known], 1))
        # All cells' mean beside each cell's own view: the camera moves them all alike.
        state = self.read(seen + self.agree(seen.mean((2, 3), keepdim=True)))
        found = self.correct(state).float()
        return flow + stride * (found[:, 2:].sigmoid() * offset + found[:, :2]), state


def _layer(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    kernel = 4 if stride == 2 else 3  # even where the stride is 2: an output then lies amid the pixels it stands for
    convolution = nn.Conv2d(inputs, outputs, kernel, stride, padding=1)
    nn.init.kaiming_normal_(convolution.weight, a=SLOPE)
    return nn.Sequential(convolution, nn.LeakyReLU(SLOPE))
