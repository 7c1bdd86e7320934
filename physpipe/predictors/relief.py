"""Faint shading brought out: it tells slopes, and a bright rim beside it would drown it (ours)."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from physpipe.predictors.layers import GROUPS

WIDTHS = (3, 7, 15)
"""Cells, odd, that brightness is compared with the mean over: the finest shading to the coarsest."""
DARKEST = 0.02
"""Brightness, 0 to 1, added before the logarithm: below it is noise."""
GAIN, MOST = 8.0, 2.0
"""Of the logarithm, that shading of some percent comes to about 1, and what is cut off beyond."""


def relief(image: Tensor) -> Tensor:
    """(B, 3, H, W): by how much, in logarithms, each place of `image` (B, 3, H, W) in [0, 1] outshines what is around.

    Around within each of WIDTHS. The same for a light twice as strong, but for noise.
    """
    bright = torch.log(image.mean(1, keepdim=True) + DARKEST)
    return torch.cat([GAIN * (bright - _smooth(bright, width)) for width in WIDTHS], dim=1).clamp(-MOST, MOST)


def _smooth(image: Tensor, width: int) -> Tensor:
    """The mean over squares of `width` twice, the edge going on outside."""
    for _ in range(2):
        image = F.avg_pool2d(F.pad(image, (width // 2,) * 4, mode="replicate"), width, stride=1)
    return image


class Wide(nn.Module):
    """Residual block of two 3 x 3 convolutions, the first one's taps `dilation` cells apart."""

    def __init__(self, channels: int, dilation: int):
        super().__init__()
        self.mend = nn.Sequential(
            nn.GroupNorm(GROUPS, channels),
            nn.SiLU(),
            nn.Conv2d(channels, channels, 3, padding=dilation, dilation=dilation),
            nn.GroupNorm(GROUPS, channels),
            nn.SiLU(),
            nn.Conv2d(channels, channels, 3, padding=1),
        )

    def forward(self, state: Tensor) -> Tensor:
        """`state`: (B, C, h, w)."""
        return state + self.mend(state)
