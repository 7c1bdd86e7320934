"""`physpipe doctor`: a check-up of the machine and the project."""

import sys
from collections import Counter

from physpipe.commands.words import Commands, Words, command
from physpipe.health import machine, pipeline, project
from physpipe.health.asking import ask
from physpipe.health.finding import lines

EXAMPLES = """\
physpipe doctor
physpipe doctor && dvc repro     runs only on a machine and a project without a problem"""


def register(commands: Commands) -> None:
    """Adds the words of this command."""
    words = command(commands, "doctor", "check this machine and this project, and say what would run again", EXAMPLES)
    words.set_defaults(command=run)


def run(words: Words) -> None:
    """Prints findings as they come; exit code 1 when one is a problem."""
    counts: Counter[str] = Counter()
    for findings in (machine.check(), project.check(ask), pipeline.check(ask)):
        for finding in findings:
            counts[finding.level] += 1
            print("\n".join(lines(finding)), flush=True)
    print(f"\n{counts['problem']} problems, {counts['warning']} warnings")
    if counts["problem"]:
        sys.exit(1)
