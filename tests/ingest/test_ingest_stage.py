"""The stage: a folder of film and a section of params.yaml to a complete folder of clips."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from physpipe.core.errors import InputError
from physpipe.io.clips import ClipSet
from stages.ingest import main


@pytest.fixture
def project(
    tmp_path: Path, roll: Callable[..., Any], film: Callable[..., Path], ingest_params: Any, monkeypatch: Any
) -> Path:
    """The current folder: params.yaml and data/raw/rink with two recordings."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    monkeypatch.delenv("PHYSPIPE_SCRATCH", raising=False)
    (tmp_path / "params.yaml").write_text(yaml.safe_dump({"datasets": {"rink": {"ingest": ingest_params}}}))
    for seed, name in enumerate("ab"):
        film(tmp_path / "data" / "raw" / "rink" / f"{name}.mkv", roll(count=45, seed=seed), np.arange(45) / 50)
    return tmp_path


def test_clips_and_recordings_are_written_together(project: Path) -> None:
    main("rink", Path("data/raw/rink"), Path("data/clips/rink"))
    film = ClipSet(Path("data/clips/rink"))
    assert film.names() == ["a_00", "a_01", "a_02", "b_00", "b_01", "b_02"]
    assert film.frames("a_02").shape == (5, 32, 32, 3)
    header = Path("data/clips/rink/recordings.csv").read_text().splitlines()[0]
    assert header == "source,claimed_fps,measured_fps,frames,kept,dropped,clips,decode_errors,missing,warnings"
    assert len(list(Path(".scratch/ingest/rink").iterdir())) == 2


def test_the_same_film_gives_the_same_bytes(project: Path) -> None:
    for out in ("one", "two"):
        main("rink", Path("data/raw/rink"), Path(out))
    for path in Path("one").iterdir():
        assert path.read_bytes() == (Path("two") / path.name).read_bytes()


def test_a_bad_recording_leaves_no_clips(project: Path) -> None:
    Path("data/raw/rink/c.mp4").write_text("words")
    with pytest.raises(InputError, match=r"c\.mp4"):
        main("rink", Path("data/raw/rink"), Path("data/clips/rink"))
    assert not Path("data/clips/rink").exists()
