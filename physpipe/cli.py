"""The command `physpipe`: what is done by hand around the pipeline."""

import argparse
import sys
from importlib import import_module

import shtab

from physpipe.commands.words import COMMANDS
from physpipe.core.errors import InputError

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
        # By name, so that help and completion need not wait for PyTorch, nor `doctor` for a sound installation.
        import_module(f"physpipe.commands.{words.command}").run(words)
    except InputError as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _parser() -> argparse.ArgumentParser:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(prog="physpipe", description=__doc__, epilog=EPILOG, formatter_class=plain)
    shtab.add_argument_to(parser, help="print the completion script of that shell")
    commands = parser.add_subparsers(required=True, dest="command", metavar="COMMAND", title="commands")
    for name, (about, examples, say) in COMMANDS.items():
        epilog = "examples:\n" + "\n".join(f"  {line}" for line in examples.splitlines())
        full = f"{about[0].upper()}{about[1:]}."
        say(commands.add_parser(name, help=about, description=full, epilog=epilog, formatter_class=plain))
    return parser


if __name__ == "__main__":
    main()
