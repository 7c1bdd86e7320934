"""The environment, read once into a map that does not fade while motion is forecast on it (ours)."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from physpipe.predictors.layers import normed_conv
from physpipe.predictors.relief import WIDTHS, Wide, relief

DILATIONS = (1, 2, 1, 2)
"""Of the blocks that read slopes off shading."""


class TerrainMap(nn.Module):
    """What a picture of the scene tells of every place in it, and one code of it all."""

    def __init__(self, channels: int):
        super().__init__()
        C = channels
        self.fine = nn.Sequential(
            normed_conv(5 + len(WIDTHS), C // 2, kernel=4, stride=2), normed_conv(C // 2, C, kernel=4, stride=2)
        )
        slopes = [Wide(C, dilation) for dilation in DILATIONS]
        self.middle = nn.Sequential(normed_conv(C, C, kernel=3, stride=1), *slopes)
        self.coarse = nn.Sequential(normed_conv(C, C, kernel=4, stride=2), normed_conv(C, C, kernel=3, stride=1))
        self.join = nn.Sequential(normed_conv(2 * C, C, kernel=1, stride=1), nn.Conv2d(C, C, 3, padding=1))

    def forward(self, frames: Tensor, aspect: Tensor) -> tuple[Tensor, Tensor]:
        """(B, C, H / 8, W / 8) map and (B, C) code of what does not move in (B, T0, 3, H, W) frames in [0, 1].

        `aspect` (2,): the frame's (width, height), half of its longer side being 1.
        """
        still = F.avg_pool2d(frames.mean(1), 2)  # a terrain is smooth
        seen = torch.cat([still - 0.5, _coordinates(still, aspect), relief(still)], dim=1)
        middle = self.middle(self.fine(seen.contiguous(memory_format=torch.channels_last)))
        coarse = self.coarse(middle)
        joined = self.join(torch.cat([middle, _enlarged(coarse, middle)], dim=1))
        return joined.float(), coarse.float().mean((2, 3))


def _coordinates(image: Tensor, aspect: Tensor) -> Tensor:
    """(B, 2, H, W): x, then y, of every pixel from the frame's centre."""
    height, width = image.shape[-2:]
    across = torch.linspace(-0.5, 0.5, width, device=image.device) * aspect[0]
    down = torch.linspace(-0.5, 0.5, height, device=image.device) * aspect[1]
    grid = torch.stack(torch.broadcast_tensors(across, down[:, None]))
    return grid.expand(len(image), -1, -1, -1)


def _enlarged(small: Tensor, like: Tensor) -> Tensor:
    """Every cell as 2 x 2 of them, cut or the edge repeated to the size of `like`."""
    rows = torch.arange(like.shape[2], device=small.device).div(2, rounding_mode="floor").clamp_max(small.shape[2] - 1)
    columns = torch.arange(like.shape[3], device=small.device).div(2, rounding_mode="floor")
    return small.index_select(2, rows).index_select(3, columns.clamp_max(small.shape[3] - 1))
