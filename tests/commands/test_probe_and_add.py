"""From a folder of film to a section that ingest accepts, and to clips."""

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from physpipe import cli
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.health.asking import ask
from physpipe.ingest.dataset import IngestParams, ingest

PARAMS = Path("params.yaml")


def section_of(printed: str) -> dict:
    return yaml.safe_load(printed[printed.index("\n  film") :])


def test_probe_prints_what_add_writes_and_changes_nothing(run, film):
    before = PARAMS.read_text()
    printed = run("probe", film)
    assert "a.mkv" in printed
    assert "deep/b.mkv" in printed
    assert "likely 1 object" in printed
    assert (PARAMS.read_text(), Path("probe_film.png").stat().st_size > 10_000) == (before, True)
    run("add", "film", film)
    after = yaml.safe_load(PARAMS.read_text())["datasets"]["film"]
    assert section_of(printed)["film"] == after
    assert after["motion"] == {"objects": 1}
    assert after["ingest"]["crop"]["width"] < 60
    assert after["ingest"]["fps"] is None


def test_comments_and_all_other_lines_stay(run, film):
    before = PARAMS.read_text()
    run("add", "film", film, "--pixels-per-metre", 250)
    text = PARAMS.read_text()
    start = text.index("  film:")
    added = text[start : start + len(text) - len(before)]
    assert text.replace(added, "", 1) == before
    assert "pixels_per_metre: 250.0" in added
    assert not [line for line in added.splitlines() if line.rstrip().endswith(("}", "]"))]


def test_dvc_keeps_what_was_added(run, film, monkeypatch):
    monkeypatch.setattr("physpipe.commands.add.ask", ask)
    ask("dvc", "init", "--no-scm", "-q")
    assert "DVC keeps the film; data/raw/film.dvc" in run("add", "film", film, "--no-probe")
    shutil.rmtree("data/raw/film")
    ask("dvc", "checkout", "-q")
    assert Path("data/raw/film/deep/b.mkv").read_bytes() == (film / "deep/b.mkv").read_bytes()


def test_where_dvc_fails_its_command_is_left_to_the_user(run, film, monkeypatch, capsys):
    def failing(*words: str) -> str:
        raise InputError(" ".join(words), "failed (no repository)", "run it by hand to see more")

    monkeypatch.setattr("physpipe.commands.add.ask", failing)
    monkeypatch.setattr("sys.argv", ["physpipe", "add", "film", str(film), "--no-probe"])
    cli.main()
    said = capsys.readouterr()
    assert "dvc add data/raw/film: failed (no repository)" in said.err
    assert "Next:\n  dvc add data/raw/film\n  dvc exp run " in said.out


def test_ingest_makes_clips_for_every_split_of_what_was_added(run, film):
    run("add", "film", film)
    clips, recordings = ingest("film", Path("data/raw/film"), read("datasets.film.ingest", IngestParams))
    splits = [clip.split for clip in clips]
    assert set(splits) == {"train", "valid", "test"}
    assert recordings["clips"].sum() == len(splits) >= 8


def test_the_user_knows_better(run, film):
    run("add", "film", film, "--objects", 3, "--crop", "1,2,40,40", "--clip-frames", 20, "--fps", 50)
    section = yaml.safe_load(PARAMS.read_text())["datasets"]["film"]
    assert section["motion"] == {"objects": 3}
    assert section["ingest"]["crop"] == {"left": 1, "top": 2, "width": 40, "height": 40}
    assert (section["ingest"]["fps"], section["ingest"]["clip_frames"], section["ingest"]["min_frames"]) == (50, 20, 20)
    assert section["predict"]["horizon"] == 10


def test_a_crop_outside_the_film_is_refused_and_nothing_begun(run, film):
    before = PARAMS.read_text()
    with pytest.raises(
        SystemExit, match=r"^error: --crop: a.mkv: the crop box ends at \(51, 5002\), outside the frame of"
    ):
        run("add", "film", film, "--crop", "1,2,50,5000")
    assert (PARAMS.read_text(), Path("data").exists()) == (before, False)


def test_a_length_given_without_a_look_has_a_horizon_inside_it(run, film):
    run("add", "film", film, "--no-probe", "--clip-frames", 12)
    assert yaml.safe_load(PARAMS.read_text())["datasets"]["film"]["predict"]["horizon"] == 10


def test_without_a_look_the_example_s_values_are_taken(run, film):
    run("add", "film", film, "--no-probe")
    sections = yaml.safe_load(PARAMS.read_text())["datasets"]
    assert sections["film"]["ingest"] == {**sections["pendulum"]["ingest"], "crop": None}


def test_film_that_cannot_be_read_is_said_and_ingest_s_business(run, film, capsys):
    for path in film.rglob("*.mkv"):
        path.write_text("no film")
    run("add", "film", film)
    assert Path("data/raw/film/a.mkv").is_file()


def test_a_section_is_named_for_the_folder_and_never_twice(run, film, tmp_path):
    odd = film.rename(tmp_path / "2 pendulums, slow!")
    assert "\n  film_2_pendulums_slow:" in run("probe", odd, "--preview", "x.png")
    printed = run("probe", odd, "--name", "pendulum", "--preview", "x.png", "--source-fps", 50)
    assert f"`physpipe add pendulum {shlex.quote(str(odd))}` gives this film to the section" in printed
    assert f"where `physpipe add pendulum_2 {shlex.quote(str(odd))} --source-fps 50` puts it" in printed
    assert "\n  pendulum_2:" in printed


def test_a_name_that_has_film_is_not_offered_again(run, film):
    run("add", "pendulum", film)
    Path("data/annotations/pendulum_2").mkdir()
    printed = run("probe", film, "--name", "pendulum")
    assert "`physpipe add pendulum " not in printed
    assert "\n  pendulum_3:" in printed


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["absent"], "no such folder"),
        (["film", "--preview", "params.yaml/x.png"], "cannot be written"),
    ],
)
def test_a_refusal_is_one_line(run, film, words, said):
    with pytest.raises(SystemExit, match=r"^error: ") as ended:
        run("probe", film.parent / words[0], *words[1:])
    assert said in str(ended.value)


def test_elsewhere_the_project_s_root_is_asked_for(run, film, monkeypatch):
    monkeypatch.chdir(film)
    with pytest.raises(SystemExit, match="run from the project's root"):
        run("probe", film)


def test_a_look_at_film_does_not_wait_for_pytorch():
    """It takes longer to load than all the rest together."""
    found = "import sys, physpipe.commands.probe, physpipe.commands.add; print('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", found], capture_output=True, text=True).stdout == "False\n"
