"""What `terrain` can be told."""

from pydantic import Field

from physpipe.core.params import Section


class TerrainParams(Section):
    """Sizes of the network, and how it learns."""

    channels: int = Field(ge=16, multiple_of=16)
    """Channels of the map, at 1/8 of the frame's size."""
    hidden: int = Field(ge=1)
    """Width of the layers of the laws of motion."""
    code: int = Field(ge=1)
    """Numbers that describe an object."""
    matched_steps: int = Field(ge=0)
    """Training steps in which the law is matched to smoothed tracks, before forecasts are trained."""
    matched_weight_s2: float = Field(ge=0)
    """Seconds squared, weight of the match in the steps after them: accelerations against positions."""
    stretches: int = Field(ge=1)
    """Stretches of a clip's track, besides the seen one, that forecasts are trained on in each step."""
    smoothing_s: float = Field(gt=0)
    """Seconds that a track is smoothed over for it, by a cubic: 5 frames or more, fewer where fewer are asked for."""
    spread_rounds: int = Field(ge=0)
    """Steps of fitting the covariance, at most; 0 = forecasts have none."""
    symmetric: bool
    """Whether a forecast is the mean over all mirrors and turns of the frame; training sees one at a time."""
