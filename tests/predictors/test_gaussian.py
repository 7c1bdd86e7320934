import math

import pytest
import torch
from torch.distributions import MultivariateNormal

from physpipe.predictors.gaussian import covariance, nll_nats


def test_a_covariance_has_the_asked_deviations_along_the_asked_directions():
    std, angle = torch.tensor([3.0, 0.5]), torch.tensor(math.pi / 6)
    cov = covariance(std, angle)
    along = torch.tensor([math.cos(angle), math.sin(angle)])
    across = torch.tensor([-along[1], along[0]])
    torch.testing.assert_close(cov @ along, 9.0 * along)
    torch.testing.assert_close(cov @ across, 0.25 * across)


def test_the_likelihood_is_that_of_torch():
    generator = torch.Generator().manual_seed(0)
    mean, target = 5 * torch.randn(2, 4, 7, 3, 2, generator=generator)
    std = 0.25 + 40 * torch.rand(4, 7, 3, 2, generator=generator)
    cov = covariance(std, 3 * torch.randn(4, 7, 3, generator=generator))
    expected = -MultivariateNormal(mean.double(), cov.double()).log_prob(target.double())
    torch.testing.assert_close(nll_nats(mean, cov, target), expected)


@pytest.mark.parametrize("std", [(0.25, 40.0), (40.0, 0.25), (0.25, 0.25)])
def test_the_flattest_ellipse_keeps_a_finite_likelihood_and_gradient(std):
    std, angle = torch.tensor(std, requires_grad=True), torch.tensor(0.7, requires_grad=True)
    nll = nll_nats(torch.zeros(2), covariance(std, angle), torch.tensor([30.0, -20.0]))
    nll.backward()
    assert nll.isfinite()
    assert std.grad.isfinite().all()
    assert angle.grad.isfinite()
