"""Whether the order of what the paper found holds here: read off the rows of docs/results/predictors.json."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from experiments.forecast_tables import LEARNED_FROM
from experiments.markdown import line, number
from experiments.spread import Row
from experiments.tracker_runs import Table

NETS = ("posnet", "dispnet", "probnet")
"""The paper's predictors with a tensor for a state."""
HEAD = """# The order of the paper's findings

Ehrhardt et al. 2018, section 5.2, and whether the rows above have the same order. "Nets" are those of `posnet`,
`dispnet` and `probnet` that have run; the best of them at T stands for them. Where a row of one side has not run, the
set is left out.
"""
Block = Mapping[str, Row]


class Finding(NamedTuple):
    """What one set says about one sentence of the paper."""

    dataset: str
    source: str
    here: str
    holds: bool


def tensor_beats_vector(block: Block) -> tuple[str, bool] | None:
    """From noisy tracks the best net errs less at T than `ifs`, whose state is a vector of positions."""
    net, ifs = _best_net(block), _error(block, "ifs", "T")
    if net is None or ifs is None:
        return None
    return f"nets {number(net[1])} px, `ifs` {number(ifs)} px at T", net[1] < ifs


def ifs_generalises(block: Block) -> tuple[str, bool] | None:
    """Beyond what was learned the error of `ifs` grows by a smaller factor, from T to 2T, than the best net's."""
    net, ifs = _best_net(block), (_error(block, "ifs", "T"), _error(block, "ifs", "2T"))
    later = None if net is None else _error(block, net[0], "2T")
    if net is None or later is None or ifs[0] is None or ifs[1] is None:
        return None
    factors = later / net[1], ifs[1] / ifs[0]
    return f"from T to 2T nets times {number(factors[0])}, `ifs` times {number(factors[1])}", factors[1] < factors[0]


def vin_fails(block: Block) -> tuple[str, bool] | None:
    """On any ground `vin`, which sees frames alone, errs more at T than a straight line through the first positions."""
    vin, straight = _error(block, "vin", "T"), _error(block, "linear", "T")
    if vin is None or straight is None:
        return None
    return f"`vin` {number(vin)} px, `linear` {number(straight)} px at T", vin > straight


FINDINGS = {
    "Tensor states beat vector states from noisy tracks": (tensor_beats_vector, ("tracks",)),
    "IFS generalises further than the nets": (ifs_generalises, tuple(LEARNED_FROM)),
    "VIN fails": (vin_fails, tuple(LEARNED_FROM)),
}
"""Sentence to how it is read off a block of rows, and the blocks it is about."""


def page(table: Mapping[str, Table]) -> str:
    """A table of all sets a finding."""
    return "\n".join([HEAD, *(_section(sentence, list(found(sentence, table))) for sentence in FINDINGS)])


def found(sentence: str, table: Mapping[str, Table]) -> Iterator[Finding]:
    """What each set whose rows have run says about a sentence of FINDINGS."""
    reads, sources = FINDINGS[sentence]
    for dataset, blocks in table.items():
        for source in sources:
            answer = reads(blocks.get(source, {}))
            if answer is not None:
                yield Finding(dataset, source, *answer)


def _section(sentence: str, answers: list[Finding]) -> str:
    if not answers:
        return f"**{sentence}.** Its rows have not run yet.\n"
    holding = sum(answer.holds for answer in answers)
    lines = [line(["set", "learned from", "here", "holds"]), line(["---", "---", "---", "---"])]
    lines += [
        line([f"`{each.dataset}`", LEARNED_FROM[each.source], each.here, "yes" if each.holds else "**no**"])
        for each in answers
    ]
    return f"**{sentence}.** Holds in {holding} of {len(answers)} rows.\n\n" + "".join(lines)


def _best_net(block: Block) -> tuple[str, float] | None:
    """The net with the least error at T, and that error."""
    errors = {name: error for name in NETS if (error := _error(block, name, "T")) is not None}
    return min(errors.items(), key=lambda each: each[1]) if errors else None


def _error(block: Block, name: str, at: str) -> float | None:
    value = block.get(name, {}).get(f"error_{at}_px")
    return None if value is None else float(value)
