"""The detector: a shallow CNN that scores every cell of a frame (paper section 3.1; layer sizes are ours)."""

from pydantic import Field
from torch import Tensor, nn

from physpipe.core.params import Section
from physpipe.tracknet.heatmap import distribution


class DetectorParams(Section):
    """Size of the detector."""

    width: int = Field(ge=4)
    """Channels of the first layers; the later ones have twice as many."""
    layers: int = Field(ge=1)
    """3x3 convolutions at the heat map's resolution."""
    stride: int = Field(ge=2, le=4, multiple_of=2)
    """Pixels per heat-map cell, 2 or 4."""


class Detector(nn.Module):
    """Frames (B, 3, H, W) in [0, 1] to scores (B, H // stride, W // stride)."""

    def __init__(self, params: DetectorParams):
        super().__init__()
        self.stride = params.stride
        wide = 2 * params.width
        # Even kernels where the stride is 2: an output then lies at the centre of the pixels that it stands for.
        stem = [_block(3, params.width, 6, stride=2)]
        stem += [_block(params.width, wide, 4, stride=2) if params.stride == 4 else _block(params.width, wide, 3)]
        body = [_block(wide, wide, 3) for _ in range(params.layers)]
        self.features = nn.Sequential(*stem, *body)
        self.score = nn.Conv2d(wide, 1, 1)
        for layer in self.modules():
            if isinstance(layer, nn.Conv2d):
                nn.init.xavier_uniform_(layer.weight)

    def forward(self, frames: Tensor) -> Tensor:
        return self.score(self.features(frames - 0.5))[:, 0].float()

    def heat(self, frames: Tensor) -> Tensor:
        """(B, h, w) probability of the object's place."""
        return distribution(self(frames))


def _block(inputs: int, outputs: int, kernel: int, stride: int = 1) -> nn.Sequential:
    convolution = nn.Conv2d(inputs, outputs, kernel, stride, padding=(kernel - stride + 1) // 2, bias=False)
    return nn.Sequential(convolution, nn.BatchNorm2d(outputs), nn.ReLU())
