"""What a run consists of, as params.yaml says."""

from pydantic import Field, ValidationInfo, field_validator

from physpipe.core.horizon import BASELINES
from physpipe.core.params import Section

SUPERVISIONS = ("tracks", "truth")
TUNED = "tuned"
"""Stands beside them for predictors that were tuned together with the tracker, on its tracks."""


class RunParams(Section):
    """What this run consists of; files of other runs may lie beside its own and are not looked at."""

    datasets: list[str]
    """Names of the data sets."""
    simulated: list[str]
    """Those of `datasets` that are simulated rather than filmed."""
    learned: list[str]
    """Predictors trained on the unsupervised tracks."""
    supervised: list[str]
    """Data sets on which they are trained on the truth too, for the paper's supervised rows."""
    flow: list[str] = Field(max_length=1)
    """The flow network that is trained and tracked with, if any: `corrflow`."""
    finetuned: list[str]
    """Those of `learned` that are tuned together with the tracker, each in a pair of its own with it."""

    @field_validator("finetuned")
    @classmethod
    def _learned_before_they_are_tuned(cls, names: list[str], known: ValidationInfo) -> list[str]:
        unlearned = [name for name in names if name not in known.data.get("learned", names)]
        if unlearned:
            raise ValueError(f"{', '.join(unlearned)} must be in `run.learned`, too")
        return names

    @property
    def predictors(self) -> list[str]:
        """All predictors, those that learn nothing first."""
        return list(dict.fromkeys([*BASELINES, *self.learned]))

    @property
    def drawn(self) -> list[str]:
        """Those whose forecasts are drawn, the learned ones first."""
        return list(dict.fromkeys([*self.learned, *BASELINES]))

    def supervisions(self, dataset: str) -> list[str]:
        """Those that predictors are trained with on `dataset`."""
        return [each for each in SUPERVISIONS if each == "tracks" or dataset in self.supervised]
