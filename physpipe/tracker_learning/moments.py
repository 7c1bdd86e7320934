"""What the tracker learns from: five moments of one film, with the film's background."""

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.determinism import device
from physpipe.core.errors import InputError
from physpipe.core.images import as_images
from physpipe.core.params import Section
from physpipe.io.clips import ClipSet
from physpipe.tracknet.discriminator import MOMENTS
from physpipe.tracknet.moments import Moments


class MomentParams(Section):
    """How moments are drawn from a clip."""

    strides: list[int] = Field(min_length=1)
    """Frames between two moments, one drawn at random; [1] = consecutive frames (paper)."""
    background_frames: int = Field(ge=3)
    """Frames of a recording, of all its clips that are learned from, whose median is its background."""


def background(films: Sequence[NDArray[np.uint8]], count: int) -> NDArray[np.uint8]:
    """(H, W, 3) temporal median over `count` frames spread evenly over films (T, H, W, 3) of one scene."""
    every = [frame for film in films for frame in film]
    chosen = np.linspace(0, len(every) - 1, min(count, len(every))).round().astype(int)
    return np.median(np.stack([every[number] for number in chosen]), axis=0).astype(np.uint8)


class MomentSampler:
    """Draws batches of Moments; a function of the generator alone."""

    def __init__(
        self,
        clips: ClipSet,
        names: Sequence[str],
        params: MomentParams,
        batch_size: int,
        ignored: Mapping[str, NDArray[np.bool_]] | None = None,
    ):
        """`ignored` maps a clip to (T, h, w) heat-map cells that are masked. Raises InputError when nothing fits."""
        reach = (MOMENTS - 1) * min(params.strides)
        self.names = [name for name in names if len(clips.rows(name)) > reach]
        if not self.names:
            raise InputError(clips.folder, f"no clip of more than {reach} frames to learn from", "ingest longer clips")
        self.params, self.batch_size, self.ignored = params, batch_size, ignored
        self.frames = {name: clips.frames(name) for name in self.names}
        self.backgrounds = self._backgrounds(clips)

    def __call__(self, generator: torch.Generator) -> Moments:
        chosen = [self._window(generator) for _ in range(self.batch_size)]
        ignored = None
        if self.ignored is not None:
            ignored = torch.from_numpy(np.stack([self.ignored[name][moments] for name, moments in chosen]))
        return Moments(
            frames=as_images(np.stack([self.frames[name][moments] for name, moments in chosen])),
            background=as_images(np.stack([self.backgrounds[name] for name, _ in chosen])),
            ignored=None if ignored is None else ignored.to(device()),
        )

    def _backgrounds(self, clips: ClipSet) -> dict[str, NDArray[np.uint8]]:
        """Of each clip: all clips of one recording share theirs, so that what rests for a while is no background."""
        by_source: dict[str, list[str]] = {}
        for name in self.names:
            by_source.setdefault(clips.rows(name)["source"].iloc[0], []).append(name)
        count, backgrounds = self.params.background_frames, {}
        for names in by_source.values():
            shared = background([self.frames[name] for name in names], count)
            backgrounds.update(dict.fromkeys(names, shared))
        return backgrounds

    def _window(self, generator: torch.Generator) -> tuple[str, NDArray[np.intp]]:
        """A clip and the five frame numbers taken from it."""

        def draw(count: int) -> int:
            return int(torch.randint(count, (), generator=generator))

        name = self.names[draw(len(self.names))]
        length = len(self.frames[name])
        fitting = [stride for stride in self.params.strides if (MOMENTS - 1) * stride < length]
        stride = fitting[draw(len(fitting))]
        first = draw(length - (MOMENTS - 1) * stride)
        return name, first + stride * np.arange(MOMENTS)
