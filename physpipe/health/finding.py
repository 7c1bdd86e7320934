"""One line of a check-up."""

from typing import Literal, NamedTuple

Level = Literal["ok", "runs", "warning", "problem"]


class Finding(NamedTuple):
    """What was looked at, and what to do about it."""

    level: Level
    """`runs`: a stage that would run again. A `problem` keeps something from running."""
    text: str
    mend: str = ""


def lines(finding: Finding) -> list[str]:
    """As printed."""
    mend = [f"{'':9}to mend: {finding.mend}"] if finding.mend else []
    return [f"{finding.level:9}{finding.text}", *mend]
