"""What the report is set by; it changes no result but the look."""

from typing import Annotated

from pydantic import Field

from physpipe.core.params import Section
from physpipe.report.plate import PlateParams
from physpipe.report.playing import FilmParams


class ReportParams(Section):
    """What the report shows."""

    predictor: str
    """Predictor of the headline figures, pictures and films; one of run.learned, or a baseline."""
    clips_shown: int = Field(ge=1)
    """Number of test clips in a data set's contact sheet, at most; a row each."""
    frames_shown: int = Field(ge=1)
    """Pictures of each of those clips, from the last seen frame to the last forecast one."""
    upscale: int = Field(ge=1)
    """Pixels of a picture per pixel of a clip."""
    trail_frames: int = Field(ge=0)
    """Past positions drawn behind a tracked object, in frames."""
    spans_shown: int = Field(ge=0)
    """Number of doubtful spans of the track in the table."""
    span_frames: int = Field(ge=1)
    """Length of a doubtful span in frames."""
    coverage_percent: list[Annotated[float, Field(gt=0, lt=100)]] = Field(min_length=1)
    """What the ellipses claim to hold whose coverage is shown, ascending."""
    plate: PlateParams
    film: FilmParams
