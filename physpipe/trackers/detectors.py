"""Files of trained detectors T1 ... TK, and the tracker that they make together."""

from collections.abc import Sequence
from pathlib import Path

from physpipe.core.params import Section
from physpipe.io import checkpoints
from physpipe.trackers.joint import PeakTracker
from physpipe.trackers.learned import LearnedTracker, ReadoutParams
from physpipe.trackers.linking import LinkParams
from physpipe.trackers.look import RefineParams
from physpipe.trackers.sequential import MaskParams, SequentialTracker
from physpipe.tracknet.model import TrackNet, TrackNetParams

WEIGHTS = "weights.pt"
"""File of the weights in a training's folder."""


def save(path: Path, nets: Sequence[TrackNet]) -> None:
    """Writes T1 ... TK with what is needed to build them again."""
    states = [{name: value.cpu() for name, value in each.state_dict().items()} for each in nets]
    about = {"params": nets[0].params.model_dump(), "frame_size": nets[0].judge.frame_size}
    checkpoints.save(path, {**about, "nets": states})


def load(path: Path) -> list[TrackNet]:
    """T1 ... TK; raises InputError for a file that holds none."""
    saved = checkpoints.load(path)
    nets = []
    for state in saved["nets"]:
        net = TrackNet(TrackNetParams.model_validate(saved["params"]), saved["frame_size"])
        checkpoints.load_into(net, state, path)
        nets.append(net)
    return nets


class TrackingParams(Section):
    """How trained detectors are used."""

    readout: ReadoutParams
    mask: MaskParams
    link: LinkParams
    refine: RefineParams | None
    """How positions are moved to the objects' middles; empty = not at all (paper)."""


def together(nets: Sequence[TrackNet], params: TrackingParams) -> SequentialTracker | PeakTracker:
    """T1 ... TK as one tracker of K objects; a detector with several peaks as one of as many as there are."""
    detectors = [LearnedTracker(each.detector, params.readout) for each in nets]
    several = nets[0].params.peaks
    if several is not None:
        return PeakTracker(detectors[0], several, params.link, params.refine)
    return SequentialTracker(detectors, params.mask)
