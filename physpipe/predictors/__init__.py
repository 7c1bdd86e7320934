"""L2: predictors of motion, from the first frames and positions of a clip to later positions."""

from physpipe.predictors.base import Predictor
from physpipe.predictors.dispnet import DispNet
from physpipe.predictors.ifs import Ifs
from physpipe.predictors.interpnet import InterpNet
from physpipe.predictors.polynomial import Linear, Persistence, Quadratic
from physpipe.predictors.posnet import PosNet
from physpipe.predictors.probnet import ProbNet
from physpipe.predictors.terrain import Terrain
from physpipe.predictors.vin import Vin

PREDICTORS: dict[str, type[Predictor]] = {
    "persistence": Persistence,
    "linear": Linear,
    "quadratic": Quadratic,
    "posnet": PosNet,
    "dispnet": DispNet,
    "probnet": ProbNet,
    "interpnet": InterpNet,
    "vin": Vin,
    "ifs": Ifs,
    "terrain": Terrain,
}
