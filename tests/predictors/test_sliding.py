"""Facts about balls that slide: those of mechanics."""

import torch

from physpipe.predictors.sliding import GRIP, SLIDE, Sliding

GROUND = 4


def test_a_sliding_ball_gives_back_two_sevenths_and_then_rolls():
    torch.manual_seed(0)
    friction = Sliding(GROUND, hidden=8)
    sliding = torch.tensor([0.03, -0.04])[None, None, None]
    gained, back, still = sliding, torch.zeros(2), torch.zeros(1, 1, 1, 2)
    with torch.no_grad():
        for _ in range(200):
            change, sliding = friction(sliding, still, torch.zeros(1, 1, 1, GROUND), still)
            assert change.norm() < GRIP * (1 + 1e-6)
            back = back + change
    torch.testing.assert_close(back, -gained / SLIDE, rtol=1e-3, atol=0)
    assert sliding.norm() < 1e-5
