"""`physpipe add`: film in, and a params.yaml that ingest accepts."""

import errno
from pathlib import Path

import pandas as pd
import pytest
import yaml

from physpipe import cli
from physpipe.core.errors import InputError
from physpipe.core.params import read
from physpipe.ingest.dataset import IngestParams

PARAMS = """\
run:
  datasets:
  - bowls
datasets:
  pendulum:
    ingest:
      fps: 15.0
      source_fps: 3.0
      crop:
        left: 3
        top: 4
        width: 5
        height: 6
      size: 128
      trim: null
      max_gap_s: 0.2
      clip_frames: 60
      min_frames: 30
      split:
        valid: 0.15
        test: 0.2
      allow_unreadable: false
    motion:
      objects: 1 # how many
    evaluate:
      ball_radius_px: 3.3
    predict:
      horizon: 14
      interpolation: null
      mirrors: false
"""


def no_dvc(*words: str) -> str:
    raise InputError(words[0], "not found", "install it")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with two videos, one with reference positions, and what lies about; the project is the cwd."""
    (tmp_path / "project").mkdir()
    (tmp_path / "project" / "params.yaml").write_text(PARAMS)
    monkeypatch.chdir(tmp_path / "project")
    monkeypatch.setattr("physpipe.commands.add.ask", no_dvc)
    folder = tmp_path / "film"
    (folder / "burst").mkdir(parents=True)
    for name in ("a.webm", "b.mp4", "LICENSE", "notes.csv", "burst/1.png", "burst/2.png", "burst/raw.txt"):
        (folder / name).write_text(name)
    (folder / "a.ref.csv").write_text("frame,x,y,area\n0,1.25,2.5,99\n1,3,4,98\n")
    return folder


def add(monkeypatch: pytest.MonkeyPatch, *words: object) -> None:
    monkeypatch.setattr("sys.argv", ["physpipe", "add", *map(str, words)])
    cli.main()


def test_film_tables_and_params_come_into_the_project(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--source-fps", 240, "--fps", 80, "--objects", 2, "--crop", "1,2,30,40", "--clip-frames", 50]
    add(monkeypatch, "rink", folder, *options)
    copied = sorted(str(path.relative_to("data/raw/rink")) for path in Path("data/raw/rink").rglob("*"))
    assert copied == ["a.webm", "b.mp4", "burst", "burst/1.png", "burst/2.png"]
    assert Path("data/raw/rink/b.mp4").read_text() == "b.mp4"
    said = Path("data/annotations/rink")
    assert (said / "templates.csv").read_text() == "clip,object,frame,x,y,w,h\n"
    assert (said / "corrections.csv").read_text() == "clip,object,frame,x,y,visible\n"
    reference = pd.read_csv(said / "reference.csv")
    assert reference.to_numpy().tolist() == [["a.webm", 0, 0, 1.25, 2.5], ["a.webm", 0, 1, 3.0, 4.0]]
    params = read("datasets.rink.ingest", IngestParams)
    assert (params.source_fps, params.fps, params.clip_frames) == (240, 80, 50)
    assert params.crop is not None
    assert params.crop.model_dump() == {"left": 1, "top": 2, "width": 30, "height": 40}
    everything = yaml.safe_load(Path("params.yaml").read_text())
    assert everything["datasets"]["rink"]["motion"] == {"objects": 2}
    assert everything["run"] == {"datasets": ["bowls"]}
    out = capsys.readouterr().out
    assert "\n  dvc add data/raw/rink\n" in out
    assert '\n  dvc exp run -S "run.datasets=[rink]" -S "run.simulated=[]" -S "run.supervised=[]"\n' in out


def test_without_options_the_films_own_rate_and_square_are_used(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add(monkeypatch, "rink", folder, "--run")
    params = read("datasets.rink.ingest", IngestParams)
    assert (params.fps, params.source_fps, params.crop, params.clip_frames) == (None, None, None, 60)
    assert yaml.safe_load(Path("params.yaml").read_text())["run"] == {"datasets": ["bowls", "rink"]}


def test_an_existing_section_is_kept_and_that_is_said(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    add(monkeypatch, "pendulum", folder)
    assert Path("params.yaml").read_text() == PARAMS
    assert "kept as it was" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rink", "absent"], "no such folder"),
        (["../rink", "film"], "not a name for a data set"),
        (
            ["rink", "film", "--clip-frames", "3"],
            "`datasets.rink.ingest.clip_frames`: Input should be greater than or equal to 5",
        ),
        (["rink", "film", "--crop=-1,0,5,5"], "`datasets.rink.ingest.crop.left`"),
        (
            ["rink", "film", "--objects", "0"],
            "`datasets.rink.motion.objects`: Input should be greater than or equal to 1",
        ),
        (["rink", "film", "--source-fps", "-5"], "`datasets.rink.ingest.source_fps`"),
        (["pendulum", "film", "--objects", "2"], "without --objects. To mend: set `datasets.pendulum.motion.objects`"),
        (["pendulum", "film", "--crop", "1,2,3,4", "--fps", "9"], "would be kept, without --fps, --crop"),
    ],
)
def test_a_refusal_is_one_line_and_changes_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], said: str
) -> None:
    words[1] = str(folder.parent / words[1])
    with pytest.raises(SystemExit, match=r"^error: ") as caught:
        add(monkeypatch, *words)
    assert said in str(caught.value)
    assert [path.name for path in Path().iterdir()] == ["params.yaml"]
    assert Path("params.yaml").read_text() == PARAMS


def test_without_positions_errors_need_the_annotator(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "a.ref.csv").unlink()
    add(monkeypatch, "rink", folder, "--no-probe")
    assert capsys.readouterr().out.endswith("To have errors measured, once it ran: physpipe annotate rink\n")


def test_the_mend_of_a_section_that_is_unsound_is_no_option(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("params.yaml").write_text(PARAMS.replace("objects: 1", "objects: none"))
    with pytest.raises(SystemExit, match=r"`datasets.pendulum.motion.objects`.*To mend: correct the section"):
        add(monkeypatch, "pendulum", folder)


@pytest.mark.parametrize("blocked", ["data", "data/raw", "data/annotations"])
def test_a_place_that_is_no_folder_is_named_and_nothing_begun(
    folder: Path, monkeypatch: pytest.MonkeyPatch, blocked: str
) -> None:
    Path(blocked).parent.mkdir(exist_ok=True)
    Path(blocked).write_text("no folder")
    with pytest.raises(SystemExit, match=rf"^error: data/.*: cannot be written \(.*: {blocked}"):
        add(monkeypatch, "rink", folder, "--no-probe")
    assert Path("params.yaml").read_text() == PARAMS
    assert not [path for path in Path().rglob("*") if "rink" in path.name]


def test_film_goes_again_where_its_section_cannot_be_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(self: Path, target: Path) -> Path:
        if Path(target).name == "params.yaml":
            raise PermissionError(errno.EACCES, "Permission denied", str(self))
        return rename(self, target)

    rename = Path.replace
    with monkeypatch.context() as locked:
        locked.setattr(Path, "replace", refused)
        with pytest.raises(SystemExit, match=r"^error: params.yaml: cannot be written \(Permission denied\)"):
            add(monkeypatch, "rink", folder, "--no-probe")
    assert Path("params.yaml").read_text() == PARAMS
    assert not [path for path in Path().rglob("*") if "rink" in path.name]
    add(monkeypatch, "rink", folder, "--no-probe")  # nothing is in the way of the next try
    assert Path("data/raw/rink/b.mp4").is_file()


def test_large_film_is_copied_whole_and_its_progress_shown(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    film = bytes(range(256)) * (5 * 2**11) + b"end"  # two and a half MiB
    (folder / "b.mp4").write_bytes(film)
    (folder / "empty.mp4").write_bytes(b"")
    add(monkeypatch, "rink", folder, "--no-probe")
    assert Path("data/raw/rink/b.mp4").read_bytes() == film
    assert Path("data/raw/rink/empty.mp4").read_bytes() == b""
    assert "copy film (MiB): 100%" in capsys.readouterr().err


def test_film_is_brought_under_dvc(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[tuple[str, ...]] = []

    def taken(*words: str) -> str:
        assert read("datasets.rink.ingest", IngestParams).size == 128  # the section is there by then
        asked.append(words)
        return ""

    monkeypatch.setattr("physpipe.commands.add.ask", taken)
    add(monkeypatch, "rink", folder, "--no-probe")
    assert asked == [("dvc", "add", "data/raw/rink")]
    out = capsys.readouterr().out
    assert "DVC keeps the film; data/raw/rink.dvc" in out
    assert "dvc add" not in out


def test_film_is_never_overwritten(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add(monkeypatch, "rink", folder)
    with pytest.raises(SystemExit, match="exists already"):
        add(monkeypatch, "rink", folder)


def test_reference_positions_need_their_columns(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "a.ref.csv").write_text("frame,x\n0,1\n")
    with pytest.raises(SystemExit, match=r"a.ref.csv: lacks column\(s\) y"):
        add(monkeypatch, "rink", folder)
    assert not Path("data/raw/rink").exists()


@pytest.fixture
def published(folder: Path) -> Path:
    """A set as others publish theirs: folders of videos, a split file, annotations as CSV."""
    film = folder.parent / "set"
    for name in ("PoolR/train/1.mp4", "PoolR/test/1.mp4", "PoolR/list.txt"):
        (film / name).parent.mkdir(parents=True, exist_ok=True)
        (film / name).write_text(name)
    (film / "splits.csv").write_text("recording,split,by\nPoolR/train/1,train,us\nPoolR/test/1.mp4,test,us\n")
    (film / "reference.csv").write_text("source,object,frame,x,y,tag\nPoolR/test/1.mp4,0,0,3.5,4,hand\n")
    (film / "templates.csv").write_text("clip,object,frame,x,y,w,h\nPoolR-test-1_00,0,0,1,2,9,9\n")
    return film


def test_a_published_set_comes_with_its_split_and_its_annotations_stay_away_from_the_film(
    published: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    add(monkeypatch, "pool", published)
    raw, said = Path("data/raw/pool"), Path("data/annotations/pool")
    copied = sorted(path.relative_to(raw).as_posix() for path in raw.rglob("*") if path.is_file())
    assert copied == ["PoolR/test/1.mp4", "PoolR/train/1.mp4", "splits.csv"]
    assert (raw / "PoolR/test/1.mp4").read_text() == "PoolR/test/1.mp4"
    assert (raw / "splits.csv").read_bytes() == (published / "splits.csv").read_bytes()
    assert sorted(path.name for path in said.iterdir()) == ["corrections.csv", "reference.csv", "templates.csv"]
    for name in ("reference.csv", "templates.csv"):
        assert (said / name).read_bytes() == (published / name).read_bytes()
    out = capsys.readouterr().out
    assert "Train, valid and test: data/raw/pool/splits.csv." in out
    assert "physpipe annotate" not in out


def test_positions_beside_nested_recordings_go_by_their_paths(published: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (published / "reference.csv").unlink()
    for number, place in enumerate(("test", "train")):
        (published / "PoolR" / place / "1.ref.csv").write_text(f"frame,x,y\n0,{number},5\n")
    add(monkeypatch, "pool", published)
    reference = pd.read_csv("data/annotations/pool/reference.csv")
    assert reference.to_numpy().tolist() == [["PoolR/test/1.mp4", 0, 0, 0, 5], ["PoolR/train/1.mp4", 0, 0, 1, 5]]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "splits.csv",
            "recording,split\nPoolR/train/2,train\n",
            r"splits.csv: \n  line 2: no recording `PoolR/train/2`",
        ),
        ("reference.csv", "source,frame,x,y\n", r"reference.csv: lacks column\(s\) object"),
        ("PoolR/test/1.ref.csv", "frame,x,y\n0,1,2\n", "reference.csv gives reference positions too"),
    ],
)
def test_a_set_with_a_bad_table_is_not_begun(
    published: Path, monkeypatch: pytest.MonkeyPatch, name: str, text: str, said: str
) -> None:
    (published / name).write_text(text)
    with pytest.raises(SystemExit, match=said):
        add(monkeypatch, "pool", published)
    assert [path.name for path in Path().iterdir()] == ["params.yaml"]


def test_help_shows_an_example(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        add(monkeypatch, "--help")
    assert "physpipe add marbles" in capsys.readouterr().out
