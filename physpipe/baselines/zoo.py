"""The trackers that ours is compared with: names, numbers, and what each is told."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

from pydantic import Field, field_validator

from physpipe.baselines.background import BackgroundParams, Model, median_blobs, subtracted_blobs
from physpipe.baselines.constant import Centre, Persistence
from physpipe.baselines.dense_flow import FlowBlob, FlowParams, FlowSimple
from physpipe.baselines.linking import Find, FinderParams, FinderTracker
from physpipe.baselines.lucas_kanade import LucasKanade, LucasKanadeParams
from physpipe.baselines.spots import TrackpyParams, odd_diameter_px, spots
from physpipe.baselines.template import TemplateParams, TemplateTracker
from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.flownet.classical import DisParams, FarnebackParams, Flow, classical_flows
from physpipe.io.annotations import Box
from physpipe.trackers.base import JointTracker, Tracker


class BaselineParams(Section):
    """Which baselines run, and their numbers: the same for every data set."""

    names: list[str]
    """Members of BASELINES."""
    box_radii: float = Field(gt=0)
    """Half the side of the box around an object's start, in its radii, where the user drew none."""
    lucas_kanade: LucasKanadeParams
    flow: FlowParams
    dis: DisParams
    farneback: FarnebackParams
    finder: FinderParams
    background: BackgroundParams
    trackpy: TrackpyParams

    @field_validator("names")
    @classmethod
    def _known(cls, names: list[str]) -> list[str]:
        unknown = sorted(set(names) - set(BASELINES))
        if unknown:
            raise ValueError(f"unknown {unknown}; known are {sorted(BASELINES)}")
        return names


class Settings(NamedTuple):
    """What the baselines may be told beside the frames and a start."""

    params: BaselineParams
    template: TemplateParams
    radius_px: float
    """The objects' radius."""
    flows: Mapping[str, Flow]
    """Dense flows by name, as `known_flows` gives them; the trackers `flow_*` follow the one named `flow`."""

    def flow(self, name: str) -> Flow:
        """Raises InputError where there is none of that name."""
        if name not in self.flows:
            mend = f"train one, or drop {name}_simple and {name}_blob from `baselines.names`"
            raise InputError(f"trackers `{name}_*`", "they need a flow network, and none was trained", mend)
        return self.flows[name]


def known_flows(params: BaselineParams) -> dict[str, Flow]:
    """The flows that need no training; picklable, as every flow must be that is put beside them."""
    return classical_flows(params.dis, params.farneback)


class Follower(NamedTuple):
    """A tracker that is told where one object is when it first shows, as in the paper."""

    build: Callable[[Settings, list[Box]], Tracker]
    """From the settings and the boxes around the object."""


class Finder(NamedTuple):
    """A tracker that finds all objects together, told how many there are and nothing of where."""

    build: Callable[[Settings], JointTracker]


def _follows(flow: str, kind: type[FlowSimple]) -> Follower:
    return Follower(lambda settings, boxes: kind(settings.flow(flow), settings.params.flow, settings.radius_px))


def _finds(find: Callable[[Settings], Find]) -> Finder:
    return Finder(lambda settings: FinderTracker(find(settings), settings.params.finder))


def _subtracted(model: Model) -> Finder:
    return _finds(lambda settings: partial(subtracted_blobs, params=settings.params.background, model=model))


def _spots(settings: Settings) -> Find:
    return partial(spots, params=settings.params.trackpy, diameter_px=odd_diameter_px(settings.radius_px))


BASELINES: dict[str, Follower | Finder] = {
    "centre": Finder(lambda settings: Centre()),
    "persistence": Follower(lambda settings, boxes: Persistence()),
    "lucas_kanade": Follower(lambda settings, boxes: LucasKanade(settings.params.lucas_kanade, settings.radius_px)),
    "mog2_blob": _subtracted("mog2"),
    "knn_blob": _subtracted("knn"),
    "median_blob": _finds(lambda settings: partial(median_blobs, params=settings.params.background)),
    "lab": Follower(lambda settings, boxes: TemplateTracker(settings.template, boxes)),
    "farneback_simple": _follows("farneback", FlowSimple),
    "farneback_blob": _follows("farneback", FlowBlob),
    "dis_simple": _follows("dis", FlowSimple),
    "dis_blob": _follows("dis", FlowBlob),
    "flow_simple": _follows("flow", FlowSimple),
    "flow_blob": _follows("flow", FlowBlob),
    "trackpy": _finds(_spots),
}
