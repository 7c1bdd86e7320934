"""`physpipe annotate` as a command: what it serves, and how it ends when it cannot."""

import signal
import subprocess
import sys
from pathlib import Path
from urllib.request import urlopen

import pytest
from rink import ANNOTATIONS, CLIPS, running

from physpipe import cli
from physpipe.annotator import serving


def annotate(monkeypatch: pytest.MonkeyPatch, *words: object) -> None:
    monkeypatch.setattr("sys.argv", ["physpipe", "annotate", *map(str, words), "--no-browser"])
    cli.main()


def refusal(monkeypatch: pytest.MonkeyPatch, *words: object) -> str:
    with pytest.raises(SystemExit, match=r"^error: ") as caught:
        annotate(monkeypatch, *words)
    return str(caught.value)


def test_the_command_serves_until_it_is_interrupted(project):
    words = [sys.executable, "-u", "-m", "physpipe.cli", "annotate", "rink", "--port", "0", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, preexec_fn=_heed_interrupts) as command:
        try:
            assert command.stdout is not None
            line = command.stdout.readline()
            assert line.startswith("Annotate rink: http://127.0.0.1:")
            assert "physpipe" in urlopen(line.split()[-1], timeout=5).read().decode()
            command.send_signal(signal.SIGINT)
            assert "Next: dvc repro" in command.communicate(timeout=10)[0]
        finally:
            command.kill()
    assert command.returncode == 0


def _heed_interrupts() -> None:
    """What a shell starts in the background, as CI may start the tests, ignores Ctrl+C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_help_shows_an_example(monkeypatch, capsys):
    with pytest.raises(SystemExit):
        annotate(monkeypatch, "--help")
    assert "physpipe annotate marbles" in capsys.readouterr().out


def test_a_port_in_use_is_told_with_the_mend(desk, monkeypatch):
    with running(desk) as page:
        said = refusal(monkeypatch, "rink", "--port", page.port)
    assert f"127.0.0.1:{page.port}: the port is in use" in said
    assert "--port" in said
    assert "no such port" in refusal(monkeypatch, "rink", "--port", 65536)


def test_three_bad_lines_are_named_at_once_and_nothing_is_served(project, annotate_files, monkeypatch):
    text = "clip,object,frame,x,y,visible\nz,0,0,1,1,true\na,0,99,1,1,true\na,0,1,1,1,perhaps\n"
    annotate_files(corrections=text)
    said = refusal(monkeypatch, "rink")
    for fault in ("no such clip: line 2", "frame beyond the clip: line 3", "`visible` is not true or false: line 4"):
        assert fault in said
    assert (ANNOTATIONS / "corrections.csv").read_text() == text


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("rnik", "did you mean `rink`?"),
        ("bowls", "`bowls`: is simulated: its truth is exact"),
        ("../rink", "no data set `../rink` (did you mean `rink`?). To mend: use one of rink, bowls, empty, other"),
        (
            "empty",
            "clips.parquet: no such file. To mend: run `physpipe add empty FOLDER`, then `dvc repro ingest@empty`",
        ),
        ("other", '-S "run.simulated=[]" -S "run.supervised=[]" ingest@other`, which makes it'),
    ],
)
def test_a_set_that_cannot_be_annotated_is_refused(project, monkeypatch, name, said):
    more = "  empty: {motion: {objects: null}}\n  other: {}\n"
    Path("params.yaml").write_text(Path("params.yaml").read_text() + more)
    assert said in refusal(monkeypatch, name)


def test_as_many_objects_are_offered_as_the_set_has_and_one_where_nobody_knows(project):
    assert serving.open_desk("rink", CLIPS, ANNOTATIONS).objects == 2
    Path("params.yaml").write_text(Path("params.yaml").read_text().replace("objects: 2", "objects: null"))
    assert serving.open_desk("rink", CLIPS, ANNOTATIONS).objects == 1
