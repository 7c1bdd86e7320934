"""What predicting and scoring agree on."""

from typing import Literal

from pydantic import Field

from physpipe.core.errors import InputError
from physpipe.core.params import Section

BASELINES: tuple[str, ...] = ("persistence", "linear", "quadratic")
"""Predictors that learn nothing; they are forecast and scored in every run."""

TrainedTo = Literal["horizon", "interpolation"]
"""The key of `PredictParams` that a predictor's training reaches."""


class PredictParams(Section):
    """How a data set's motion is forecast, and how far."""

    horizon: int = Field(ge=1)
    """T: the last frame that predictors learn to forecast, the first seen one being frame 0."""
    interpolation: int | None = Field(ge=1)
    """The same for predictors that are trained longer, or see that frame; empty where the clips are too short."""
    mirrors: bool
    """Whether film of this set, mirrored or turned, could be film of this set, too, and is learned from."""

    def last_frame(self, trained_to: TrainedTo, section: str) -> int:
        """The last frame that a training reaches; raises InputError when `section` (self's key) leaves it empty."""
        if trained_to == "horizon":
            return self.horizon
        if self.interpolation is None:
            reason = "is empty, and a predictor with `trained_to: interpolation` needs it"
            raise InputError(f"params.yaml: `{section}.interpolation`", reason, "give a frame that the clips reach")
        return self.interpolation
