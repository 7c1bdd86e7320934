"""How many objects a data set's clips show, which every stage that tracks is told."""

from pydantic import Field

from physpipe.core.params import Section


class ObjectsParams(Section):
    """What moves in a data set's clips."""

    objects: int | None = Field(ge=1)
    """Number of objects; empty = as many as move in most clips, for a tracker that finds all at once."""
