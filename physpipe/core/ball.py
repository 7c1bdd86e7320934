"""What the evaluation may know of a data set's objects; nothing unsupervised reads it."""

from pydantic import Field

from physpipe.core.params import Section


class BallParams(Section):
    """Size of the objects."""

    ball_radius_px: float = Field(gt=0)
    """Radius of an object in clip pixels; sets when a tracker counts as off track."""
