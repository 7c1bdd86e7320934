"""Learn dense optical flow from drawn pairs of pictures."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.params import read
from physpipe.flow_learning.flow import FlowParams, learn_flow
from physpipe.flow_learning.verdict import save_flow
from physpipe.flownet.classical import DisParams, FarnebackParams, classical_flows
from physpipe.io.checkpoints import forget, scratch


def main(name: str, out: Path) -> None:
    """Writes weights, curve, pictures and verdict of the flow network `name` to the folder `out`."""
    params, compute = read(f"flow.{name}", FlowParams), read("compute", ComputeParams)
    prepare(compute)
    folder = scratch("train_flow", [params, compute], [])
    net, curve = learn_flow(params, compute.seed, folder / "training.pt")
    untrained = classical_flows(read("baselines.dis", DisParams), read("baselines.farneback", FarnebackParams))
    save_flow(out, net, curve, params.pairs, params.verdict, untrained)
    forget(folder)


if __name__ == "__main__":
    run(main)
