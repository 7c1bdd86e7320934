"""Balls on springs, filmed small, shared by tests of predictors; never square."""

import math
from collections.abc import Callable

import torch
from torch import Tensor

from physpipe.core.determinism import torch_generator
from physpipe.predictors.base import Predictor, Seen, Window

HEIGHT, WIDTH = 48, 64
STATE = {"stem": 8, "channels": 16, "hidden": 16, "follow": True, "symmetric": True, "objects_alike": True}
"""Params of the smallest tensor state that learns."""


def springs(clips: int, frames: int, sees_end: bool = False) -> Window:
    """One ball a clip on a spring to the frame's centre, as a red spot; the first four frames are seen."""
    generator = torch_generator(0)
    amplitude = 12 * torch.randn(clips, 1, 2, generator=generator)
    phase = 6 * torch.rand(clips, 1, 2, generator=generator)
    times = torch.arange(frames, dtype=torch.float32).expand(clips, -1)
    xy = torch.tensor([WIDTH, HEIGHT]) / 2 + amplitude * torch.cos(0.25 * times[..., None] + phase)
    seen = [0, 1, 2, 3, *([frames - 1] if sees_end else [])]
    xy = xy.unsqueeze(2)
    return Window(Seen(spots(xy[:, seen, 0]), xy[:, :4], times[:, seen]), times[:, 4:], xy[:, 4:], 80.0, xy)


def spots(xy: Tensor) -> Tensor:
    """(B, T, 3, H, W): a red spot at `xy` (B, T, 2) px."""
    x, y = torch.arange(WIDTH), torch.arange(HEIGHT)[:, None]
    red = torch.exp(-((x - xy[..., 0, None, None]) ** 2 + (y - xy[..., 1, None, None]) ** 2) / 18)
    return torch.stack([red, torch.zeros_like(red), torch.zeros_like(red)], dim=2)


def distances_by_learning(net: Predictor, window: Window, steps: int) -> tuple[float, float]:
    """Mean distance in px before and after learning one batch by heart."""
    before = distance(net, window)
    losses_by_learning(net, lambda step: window, steps, rate=3e-3)
    return before, distance(net, window)


def losses_by_learning(
    net: Predictor, draw: Callable[[int], Window], steps: int, rate: float, clip_norm: float = math.inf
) -> list[float]:
    """The loss of every step of learning the windows that `draw` gives for it."""
    optimiser = torch.optim.Adam(net.parameters(), lr=rate)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
    losses = []
    for step in range(steps):
        optimiser.zero_grad()
        loss, _parts = net.loss(draw(step), torch_generator(0))
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), clip_norm)
        optimiser.step()
        schedule.step()
        losses.append(loss.item())
    return losses


def distance(net: Predictor, window: Window) -> float:
    """Mean distance of the forecasts in px, as a training sees them."""
    with torch.no_grad():
        return (net.train()(window.seen, window.asked_times).mean - window.target).norm(dim=-1).mean().item()
