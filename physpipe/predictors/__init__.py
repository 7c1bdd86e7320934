"""L2: predictors of motion, from the first frames and positions of a clip to later positions."""

from physpipe.predictors.base import Predictor
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.ifs import Ifs
from physpipe.predictors.polynomial import Linear, Persistence, Quadratic
from physpipe.predictors.vin import Vin

PREDICTORS: dict[str, type[Predictor]] = {
    "persistence": Persistence,
    "linear": Linear,
    "quadratic": Quadratic,
    "dispnet": DispNet,
    "vin": Vin,
    "ifs": Ifs,
}
