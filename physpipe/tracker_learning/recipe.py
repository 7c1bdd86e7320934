"""What the unsupervised tracker's training is set by."""

from pydantic import Field

from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.learning.training import FitParams
from physpipe.tracker_learning.moments import MomentParams
from physpipe.trackers.detectors import TrackingParams
from physpipe.tracknet.model import TrackNetParams
from physpipe.tracknet.signals import LockParams, SignalParams


class RecipeParams(Section):
    """One way to learn a detector."""

    net: TrackNetParams
    moments: MomentParams
    starts: int = Field(ge=1)
    """Short trainings from scratch, of which the best one goes on, judged without labels."""
    start: FitParams
    """Training of each start."""
    rest: FitParams
    """Training of the best start to its end, and of each further object's detector."""


class TrackerParams(Section):
    """The unsupervised tracker."""

    recipe: str
    """A key of `recipes`."""
    recipes: dict[str, RecipeParams]
    signals: SignalParams
    lock: LockParams
    tracking: TrackingParams
    least_motion: float = Field(ge=0, le=1)
    """Share of the motion that must be left outside the masks for there to be another object."""

    def chosen(self) -> RecipeParams:
        """The recipe to run; raises InputError for a name that is not in `recipes`."""
        if self.recipe not in self.recipes:
            raise InputError("tracker.recipe", f"no recipe `{self.recipe}`", f"use one of {sorted(self.recipes)}")
        return self.recipes[self.recipe]
