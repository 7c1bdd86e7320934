"""Interaction network: what an object does by itself, and what each of the others does to it, added up.

Battaglia et al. 2016 (arXiv 1612.00222), in the form of the cores of Watters et al. 2017 (arXiv 1706.01433, section 2):
a self-dynamics, a relation, an affector and an output network, each a perceptron. Their widths are ours.
"""

from typing import TypeVar

import torch
from torch import Tensor, nn

Layer = TypeVar("Layer", nn.Linear, nn.Conv2d)


class InteractionCore(nn.Module):
    """One step of every object's state. One set of weights for all objects: permuting them permutes the result."""

    def __init__(self, inputs: int, hidden: int, outputs: int):
        super().__init__()
        self.own = nn.Sequential(perceptron(inputs, hidden, hidden), nn.ReLU())
        self.relation = nn.Sequential(perceptron(2 * inputs, hidden, hidden), nn.ReLU())
        self.affect = nn.Sequential(perceptron(hidden, hidden, hidden), nn.ReLU())
        self.output = perceptron(inputs + hidden, hidden, outputs)

    def forward(self, states: Tensor) -> Tensor:
        """(B, K, outputs) from `states` (B, K, inputs); a lone object has no relations."""
        effect = self.own(states)
        if states.shape[1] > 1:
            effect = effect + self._of_others(states)
        return self.output(torch.cat([states, self.affect(effect)], dim=-1))

    def _of_others(self, states: Tensor) -> Tensor:
        """(B, K, hidden): what the K - 1 others do to each object."""
        others = torch.stack([states.roll(turn, dims=1) for turn in range(1, states.shape[1])], dim=1)
        pairs = torch.cat([states.unsqueeze(1).expand_as(others), others], dim=-1)  # (B, K - 1, K, 2 * inputs)
        return self.relation(pairs).sum(1)


def perceptron(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    """Two layers with a ReLU between them."""
    return nn.Sequential(xavier(nn.Linear(inputs, hidden)), nn.ReLU(), xavier(nn.Linear(hidden, outputs)))


def xavier(layer: Layer) -> Layer:
    """The layer with Xavier's weights (Ehrhardt et al. 2018, section 5) and no bias.

    torch's own are little more than half as large, and no signal survives that in the dozens of layers of a recurrence.
    """
    nn.init.xavier_uniform_(layer.weight)
    if layer.bias is not None:
        nn.init.zeros_(layer.bias)
    return layer
