"""What predicting and scoring agree on."""

from pydantic import Field

from physpipe.core.params import Section

BASELINES: tuple[str, ...] = ("persistence", "linear", "quadratic")
"""Predictors that learn nothing; they are forecast and scored in every run."""


class PredictParams(Section):
    """How far a data set's motion is forecast."""

    horizon: int = Field(ge=1)
    """T: the last frame that predictors learn to forecast, the first seen one being frame 0."""
