"""A project with the filmed set `rink`, and what was said about it."""

from pathlib import Path

import pytest
from flask.testing import FlaskClient
from rink import ADDRESS, ANNOTATIONS, CLIPS, PARAMS, save_clips

from physpipe.annotator import serving
from physpipe.annotator.app import Desk, create_app
from physpipe.io.clips import ClipSet


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory: params.yaml, and the clips `a` and `b` of the set `rink`."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    Path("params.yaml").write_text(PARAMS)
    save_clips()
    return tmp_path


@pytest.fixture
def clips(project: Path) -> ClipSet:
    return ClipSet(CLIPS)


@pytest.fixture
def desk(project: Path) -> Desk:
    return serving.open_desk("rink", CLIPS, ANNOTATIONS)


@pytest.fixture
def client(desk: Desk) -> FlaskClient:
    """Asks the application that expects to be at ADDRESS, without a network."""
    return create_app(desk, ADDRESS).test_client()


@pytest.fixture
def annotate_files():
    """A folder of annotations from CSV texts, named by file."""

    def written(**files: str) -> Path:
        ANNOTATIONS.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (ANNOTATIONS / f"{name}.csv").write_text(text)
        return ANNOTATIONS

    return written
