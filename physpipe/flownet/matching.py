"""What flow networks are made of: correlation of two feature maps, warping by a flow, sharp upsampling."""

import math

import torch
import torch.nn.functional as F
from torch import Tensor


def correlation(first: Tensor, second: Tensor, radius: int) -> Tensor:
    """(B, N, h, w) mean product over C of each cell of `first` (B, C, h, w) and N = (2 radius + 1)^2 of `second`.

    Entry n of cell (y, x) looks at (y + n // side - radius, x + n % side - radius); beyond the border it is 0.
    """
    side, height = 2 * radius + 1, first.shape[2]
    rows = (first.float() / first.shape[1]).permute(2, 0, 3, 1).contiguous()  # (h, B, w, C)
    padded = F.pad(second.float(), [radius] * 4).permute(2, 0, 1, 3).contiguous()  # (h + 2r, B, C, w + 2r)
    with torch.autocast(first.device.type, enabled=False):  # else neighbours on faint ground round alike
        bands = [_band(rows @ padded[y : y + height], side) for y in range(side)]
    return torch.cat(bands, dim=-1).permute(1, 3, 0, 2)


def _band(products: Tensor, side: int) -> Tensor:
    """(..., w, side) of (..., w, w + side - 1): entries x to x + side - 1 of each row x."""
    w, n = products.shape[-2:]
    return F.pad(products.flatten(-2), (0, w)).unflatten(-1, (w, n + 1))[..., :side]


def likeliest_offset(matches: Tensor, sharpness: Tensor) -> Tensor:
    """(B, 2, h, w) mean offset in cells (x, y) of (B, N, h, w) matches, weighted by a softmax of that sharpness."""
    radius = (math.isqrt(matches.shape[1]) - 1) // 2
    steps = torch.arange(-radius, radius + 1, device=matches.device, dtype=matches.dtype)
    share = (sharpness * matches).softmax(1).unflatten(1, (2 * radius + 1, 2 * radius + 1))
    x, y = share.sum(1), share.sum(2)  # (B, side, h, w) each
    return torch.stack([(each * steps[:, None, None]).sum(1) for each in (x, y)], dim=1)


def warp(image: Tensor, flow: Tensor) -> Tensor:
    """(B, C, h, w) `image` looked up bilinearly at each cell's own place plus `flow` (B, 2, h, w) cells (x, y).

    Undoes the flow: `image` is the second picture, the result is the first. Places beyond the border take the
    border's value. No gradient reaches the flow. By indexing, since the gradient of torch's `grid_sample` is not
    deterministic on GPUs.
    """
    B, C, height, width = image.shape
    flow = flow.detach().float()
    x = (flow[:, 0] + torch.arange(width, device=flow.device)).clamp(0, width - 1)
    y = (flow[:, 1] + torch.arange(height, device=flow.device)[:, None]).clamp(0, height - 1)
    left, top = x.floor().clamp_max(width - 2).long(), y.floor().clamp_max(height - 2).long()
    right, down = (x - left)[..., None].to(image.dtype), (y - top)[..., None].to(image.dtype)
    cells = image.permute(0, 2, 3, 1).reshape(-1, C)
    corner = (torch.arange(B, device=flow.device)[:, None, None] * height + top) * width + left

    def at(offset: int) -> Tensor:
        return cells.index_select(0, (corner + offset).flatten()).view(B, height, width, C)

    upper = torch.lerp(at(0), at(1), right)
    lower = torch.lerp(at(width), at(width + 1), right)
    return torch.lerp(upper, lower, down).permute(0, 3, 1, 2)


def convex_upsample(flow: Tensor, weights: Tensor) -> Tensor:
    """(B, 2, 2 h, 2 w): each fine pixel a mean of the 3 x 3 coarse cells around its own, weighted by a softmax.

    `weights` (B, 36, h, w) holds 9 logits for each of the 2 x 2 fine pixels of a cell. Keeps edges sharp where
    bilinear upsampling smears them (Teed and Deng 2020).
    """
    B, _, height, width = flow.shape
    share = weights.float().view(B, 1, 9, 2, 2, height, width).softmax(2)
    around = F.unfold(F.pad(flow.float(), [1] * 4, mode="replicate"), 3).view(B, 2, 9, 1, 1, height, width)
    fine = (share * around).sum(2)  # (B, 2, 2, 2, h, w): fine row and column before the coarse ones
    return fine.permute(0, 1, 4, 2, 5, 3).reshape(B, 2, 2 * height, 2 * width)


def enlarged(values: Tensor, factor: int) -> Tensor:
    """(B, C, factor h, factor w) of (B, C, h, w), bilinear; edges of pixels map onto edges."""
    return F.interpolate(values, scale_factor=factor, mode="bilinear", align_corners=False)
