"""The command line: quick, with help and completion for every command, and exit codes that are kept."""

import subprocess
import sys
from pathlib import Path

import pytest

from physpipe import cli
from physpipe.commands.words import COMMANDS, FILMS, FORMATS, SPLITS
from physpipe.exporting import encoding, formats
from physpipe.io import clips

MODULES = Path(cli.__file__).parent / "commands"


def test_every_command_has_a_module_and_every_module_of_a_command_is_one():
    assert set(COMMANDS) <= {path.stem for path in MODULES.glob("*.py")}
    runs = {path.stem for path in MODULES.glob("*.py") if "\ndef run(" in path.read_text()}
    assert runs == set(COMMANDS)


def test_splits_are_the_clips_splits():
    assert SPLITS == clips.SPLITS


def test_formats_are_those_that_can_be_written():
    assert set(FORMATS) == set(formats.FORMATS)
    assert set(FILMS) == set(encoding.FORMATS)


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example_for_every_command(name, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["physpipe", name, "--help"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    assert f"examples:\n  physpipe {name}" in capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "tcsh", "powershell"])
def test_every_shell_gets_completion(shell, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["physpipe", "--print-completion", shell])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    script = capsys.readouterr().out
    assert all(name in script for name in COMMANDS)


def test_help_waits_for_no_large_library():
    slow = "'torch', 'pandas', 'cv2', 'matplotlib', 'av'"
    script = f"from physpipe import cli; import sys; cli._parser(); sys.exit(any(n in sys.modules for n in ({slow})))"
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ([], 2),
        (["dance"], 2),
        (["export", "bowls"], 2),
        (["export", "bowls", "--to", "xls"], 2),
        (["add", "a", ".", "--crop", "1,2,x,3"], 2),
        (["add", "a", ".", "--crop", "1,2,3"], 2),
    ],
)
def test_words_that_cannot_be_read_end_with_2(words, code, monkeypatch):
    monkeypatch.setattr("sys.argv", ["physpipe", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == code


def test_an_interruption_ends_with_130(monkeypatch, tmp_path):
    def interrupted(words):
        raise KeyboardInterrupt

    monkeypatch.setattr("physpipe.commands.doctor.run", interrupted)
    monkeypatch.setattr("sys.argv", ["physpipe", "doctor"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 130
