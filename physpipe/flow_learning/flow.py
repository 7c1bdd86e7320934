"""Learning optical flow from drawn pairs, whose flow is exact."""

from pathlib import Path

import pandas as pd
import torch
from pydantic import Field

from physpipe.core.determinism import torch_generator
from physpipe.core.params import Section
from physpipe.core.precision import brief
from physpipe.flow_learning.film import PairParams, as_batch, draw_pairs
from physpipe.flow_learning.verdict import VerdictParams
from physpipe.flownet.network import CorrFlow, CorrFlowParams, endpoint_errors
from physpipe.learning.training import FitParams, Rank, fit

VALID = (0, 0, 1)
"""Key of the pairs that choose the weights: the same whatever is learned, and no training step's (those are > 0)."""


class FlowParams(Section):
    """A flow network and its training."""

    network: CorrFlowParams
    pairs: PairParams
    fit: FitParams
    valid_pairs: int = Field(ge=1)
    """Pairs by which the weights to keep are chosen."""
    verdict: VerdictParams


def learn_flow(params: FlowParams, seed: int, checkpoint: Path) -> tuple[CorrFlow, pd.DataFrame]:
    """The network with the weights of the lowest error on held-out pairs, and its learning curve.

    Every step draws pairs of its own: drawing costs a tenth of what learning from them does.
    """
    net, batch_size = CorrFlow(params.network), params.fit.batch_size
    held_out = draw_pairs(params.pairs, params.valid_pairs, torch_generator(*VALID))
    batches = [as_batch(held_out[start : start + batch_size]) for start in range(0, len(held_out), batch_size)]

    def validate() -> Rank:
        """Error inside the objects and outside them, pixels, weighed alike."""
        with brief():
            errors = [endpoint_errors(net(batch.first, batch.second), batch).sum() for batch in batches]
        return (torch.stack(errors).mean().item(),)

    curve = fit(
        net,
        lambda generator: as_batch(draw_pairs(params.pairs, batch_size, generator)),
        validate,
        params.fit,
        seed,
        checkpoint,
        "corrflow",
    )
    return net, curve
