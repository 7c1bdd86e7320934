"""Facts about what the tracker learns from."""

import numpy as np
import pytest
import torch
import worlds

from physpipe.core.determinism import torch_generator
from physpipe.core.errors import InputError
from physpipe.tracker_learning.moments import MomentParams, MomentSampler, background


@pytest.fixture
def clips(tmp_path):
    """Film whose every frame is one grey level: ten times the clip's number plus the frame's number."""
    films = [np.full((16, 8, 12, 3), 0, np.uint8) + np.arange(16, dtype=np.uint8)[:, None, None, None] for _ in "abc"]
    return worlds.save_clips(tmp_path / "clips", films)


def test_moments_are_evenly_spaced_in_natural_order(clips):
    sampler = MomentSampler(clips, clips.names(), MomentParams(strides=[1, 2, 3], background_frames=5), batch_size=64)
    frames = sampler(torch_generator(0)).frames
    assert frames.shape == (64, 5, 3, 8, 12)
    numbers = (255 * frames[:, :, 0, 0, 0]).round()
    steps = numbers.diff(dim=1)
    assert (steps == steps[:, :1]).all()
    assert steps.unique().tolist() == [1, 2, 3]


def test_the_same_generator_draws_the_same_batch(clips):
    sampler = MomentSampler(clips, clips.names(), MomentParams(strides=[1, 2], background_frames=5), batch_size=8)
    assert torch.equal(sampler(torch_generator(3)).frames, sampler(torch_generator(3)).frames)
    assert not torch.equal(sampler(torch_generator(3)).frames, sampler(torch_generator(4)).frames)


def test_a_stride_too_long_for_a_clip_is_not_drawn(clips):
    sampler = MomentSampler(clips, clips.names(), MomentParams(strides=[2, 4], background_frames=5), batch_size=32)
    numbers = (255 * sampler(torch_generator(0)).frames[:, :, 0, 0, 0]).round()
    assert numbers.diff(dim=1).unique().tolist() == [2]


def test_clips_too_short_for_five_moments_are_refused_by_name(clips):
    with pytest.raises(InputError, match="no clip of more than 16 frames"):
        MomentSampler(clips, clips.names(), MomentParams(strides=[4], background_frames=5), batch_size=1)


def test_the_mask_goes_with_its_frames(clips):
    ignored = {name: np.zeros((16, 2, 3), bool) for name in clips.names()}
    for mask in ignored.values():
        mask[::2] = True
    params = MomentParams(strides=[1], background_frames=5)
    batch = MomentSampler(clips, clips.names(), params, 16, ignored)(torch_generator(0))
    even = (255 * batch.frames[:, :, 0, 0, 0]).round() % 2 == 0
    assert torch.equal(batch.ignored.flatten(2).all(2), even)


def test_the_background_is_what_stays():
    frames = worlds.draw(worlds.orbit(40, 0.3)[:, None], [worlds.RED], seed=0)
    still = worlds.draw(np.full((1, 1, 2), -50.0), [worlds.RED], seed=0)[0]
    assert np.abs(background([frames], 25).astype(int) - still).max() < 12  # grey levels, of noise 2
