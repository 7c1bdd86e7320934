"""`physpipe doctor`: a check-up of the machine and the project."""

import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Iterator

from physpipe.health import machine
from physpipe.health.finding import Finding, lines
from physpipe.health.wording import counted


def run(words: Namespace) -> None:
    """Prints findings as they come; exit code 1 when one is a problem."""
    counts: Counter[str] = Counter()
    for finding in _findings():
        counts[finding.level] += 1
        print("\n".join(lines(finding)), flush=True)
    kinds = counted(counts["runs"], "kind of stages", "kinds of stages")
    print(f"\n{counted(counts['problem'], 'problem')}, {counted(counts['warning'], 'warning')}, {kinds} would run")
    if counts["problem"]:
        sys.exit(1)


def _findings() -> Iterator[Finding]:
    yield from machine.check()
    try:  # late, since it imports everything, and a check-up must survive what is broken
        from physpipe.health import pipeline, project
        from physpipe.health.asking import ask
    except Exception as error:
        yield Finding("problem", f"the library cannot be loaded ({error})", machine.INSTALL)
        return
    yield from project.check(ask)
    print("asking DVC what would run: seconds, minutes where much film is new ...", file=sys.stderr, flush=True)
    yield from pipeline.check(ask)
