"""What makes a simulated data set."""

from typing import Literal

from pydantic import Field, model_validator

from physpipe.core.params import Section
from physpipe.scenes.balls import Rgb
from physpipe.scenes.film import CameraParams
from physpipe.scenes.height_field import HeightsParams
from physpipe.scenes.look import LookParams
from physpipe.scenes.physics import PhysicsParams
from physpipe.scenes.terrains import AnyTerrainParams


class BallsParams(Section):
    """How many balls, what they are, and how each is let go."""

    count: int = Field(ge=1)
    """Balls in every clip, numbered from 0."""
    colours: Literal["listed", "different", "same"]
    """`listed`: ball i has the palette's colour i; `different`: colours drawn for each clip, no two alike; `same`: one
    colour drawn for each clip."""
    radius_m: tuple[float, float]
    """Range of the radii, each drawn for each ball and clip, in metres."""
    start_level: tuple[float, float]
    """Range of the distance from the middle at the start, in parts of the distance to the border."""
    start_speed_m_s: tuple[float, float]
    """Range of the speed at the start, in metres per second."""
    heading_spread_deg: float = Field(ge=0, le=180)
    """Largest angle between a ball's first heading and the way to the middle; 180 is any direction."""

    @model_validator(mode="after")
    def _radii_are_positive_and_ordered(self) -> "BallsParams":
        if not 0 < self.radius_m[0] <= self.radius_m[1]:
            raise ValueError(f"{list(self.radius_m)} is no range of positive radii")
        return self


class WorldParams(Section):
    """A simulated data set."""

    clips: int = Field(ge=1)
    """Number of recordings."""
    still_frames: tuple[int, int]
    """Range of the number of source frames during which the balls are held before they are let go."""
    moving_frames: int = Field(ge=2)
    """Source frames from the release on."""
    terrain: AnyTerrainParams
    balls: BallsParams
    palette: list[Rgb] = Field(min_length=1)
    """Colours of balls, 0 to 255."""
    physics: PhysicsParams
    look: LookParams
    camera: CameraParams

    @model_validator(mode="after")
    def _palette_suffices(self) -> "WorldParams":
        if self.balls.colours != "same" and self.balls.count > len(self.palette):
            raise ValueError(
                f"{self.balls.count} balls of {self.balls.colours} colours, {len(self.palette)} in palette"
            )
        return self

    @model_validator(mode="after")
    def _no_ball_is_larger_than_the_tightest_bend(self) -> "WorldParams":
        if isinstance(self.terrain, HeightsParams) and self.balls.radius_m[1] >= self.terrain.tightest_m:
            raise ValueError(
                f"balls of {self.balls.radius_m[1]} m on a terrain that bends by {self.terrain.tightest_m} m"
            )
        return self
