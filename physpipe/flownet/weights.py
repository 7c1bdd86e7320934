"""Files of trained flow networks."""

from pathlib import Path

from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.flownet.network import CorrFlow, CorrFlowParams
from physpipe.io import checkpoints

WEIGHTS = "weights.pt"
"""File of the weights in a training's folder."""


def save(folder: Path, net: CorrFlow) -> None:
    """Writes the weights with what is needed to build the network again."""
    state = {name: value.cpu() for name, value in net.state_dict().items()}
    checkpoints.save(folder / WEIGHTS, {"params": net.params.model_dump(), "state": state})


def load(folder: Path) -> CorrFlow:
    """The trained network; raises InputError when the folder holds none."""
    path = folder / WEIGHTS
    saved = checkpoints.load(path)
    try:
        net = CorrFlow(CorrFlowParams.model_validate(saved.get("params")))
    except ValidationError as error:
        reason = f"params of another model ({error})"
        raise InputError(path, reason, "run `dvc repro` to train it again") from None
    checkpoints.load_into(net, saved["state"], path)
    return net.eval()
