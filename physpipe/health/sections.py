"""The sections that every data set has in params.yaml; in a module of its own, as it is quick to load."""

from physpipe.core.ball import BallParams
from physpipe.core.horizon import PredictParams
from physpipe.core.objects import ObjectsParams
from physpipe.core.params import Section
from physpipe.ingest.dataset import IngestParams

OF_A_SET: dict[str, type[Section]] = {
    "ingest": IngestParams,
    "motion": ObjectsParams,
    "evaluate": BallParams,
    "predict": PredictParams,
}
