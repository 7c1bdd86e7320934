"""What the commands' words have in common."""

import argparse
from pathlib import Path
from typing import TypeAlias

Words = argparse.Namespace
Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


def command(commands: Commands, name: str, about: str, examples: str) -> argparse.ArgumentParser:
    """A new command whose `--help` says what it is `about` and ends with `examples`, a line each."""
    return commands.add_parser(
        name,
        help=about,
        description=f"{about[0].upper()}{about[1:]}.",
        epilog="examples:\n" + "\n".join(f"  {line}" for line in examples.splitlines()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def out_of(words: argparse.ArgumentParser, default: str) -> None:
    """Adds the word for the folder that a command writes."""
    words.add_argument("--out", type=Path, metavar="FOLDER", help=f"new, or of an earlier export (default: {default})")
