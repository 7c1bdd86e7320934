"""L2: predictors of motion, from the first frames and positions of a clip to later positions."""

from physpipe.predictors.base import Predictor
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.polynomial import Linear, Persistence, Quadratic

PREDICTORS: dict[str, type[Predictor]] = {
    "persistence": Persistence,
    "linear": Linear,
    "quadratic": Quadratic,
    "dispnet": DispNet,
}
