"""The command `physpipe`: what is done by hand around the pipeline."""

import argparse
import sys

import shtab

from physpipe.commands import add, doctor, export, overlay, probe
from physpipe.core.errors import InputError

COMMANDS = (probe, add, doctor, export, overlay)
"""Each module's `register` adds its words to the parser."""
EPILOG = """\
exit codes:
  0    done
  1    something given cannot be used, and nothing was written; or `doctor` found a problem
  2    the command line cannot be read
  130  interrupted by Ctrl-C

from a folder of videos to tracks:
  physpipe probe ~/film              what is in it, and what will hurt
  physpipe add marbles ~/film        bring it in
  dvc repro                          or the command that `add` prints

completion of commands, options and paths by the Tab key:
  physpipe --print-completion bash > ~/.local/share/bash-completion/completions/physpipe
  (also zsh, fish, tcsh, powershell)
"""
INTERRUPTED = 130


def main() -> None:
    """Runs one command; a user's mistake ends as one line, not a traceback."""
    words = _parser().parse_args()
    try:
        words.command(words)
    except InputError as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _parser() -> argparse.ArgumentParser:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(prog="physpipe", description=__doc__, epilog=EPILOG, formatter_class=plain)
    shtab.add_argument_to(parser, help="print the completion script of that shell")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", title="commands")
    for each in COMMANDS:
        each.register(commands)
    return parser


if __name__ == "__main__":
    main()
