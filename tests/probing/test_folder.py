"""A folder of film is looked at as a whole; what cannot be read is named."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from physpipe.core.errors import InputError
from physpipe.ingest.splits import SplitParams
from physpipe.probing import sheet
from physpipe.probing.crop import geometry
from physpipe.probing.folder import probe
from physpipe.probing.text import described

SHARES = SplitParams(valid=0.2, test=0.35)


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")


def test_what_cannot_be_read_is_named_beside_what_can(roll: Callable[..., Path]) -> None:
    folder = roll().parent
    (folder / "broken.mp4").write_text("no film")
    probed = probe(folder, 32, SHARES, None)
    assert [each.source for each in probed.found] == ["a.mkv"]
    assert "broken.mp4" in str(probed.unreadable[0])
    said = "\n".join(described(probed, 32))
    assert "90 x 60 px, 100 frames, 100 frames/s" in said
    assert "likely 1 object of about" in said
    assert "! " in said
    assert "broken.mp4: not a readable video" in said


def test_a_folder_without_a_readable_film_is_refused_and_each_named(tmp_path: Path) -> None:
    for name in ("a.mp4", "b.mp4"):
        (tmp_path / name).write_text("no film")
    with pytest.raises(InputError, match=r"(?s)no recording can be read.*a\.mp4.*b\.mp4"):
        probe(tmp_path, 32, SHARES, None)


def test_the_contact_sheet_marks_what_moves(roll: Callable[..., Path], tmp_path: Path) -> None:
    probed = probe(roll().parent, 32, SHARES, None)
    places = [geometry(each, probed.advice.crop, 32) for each in probed.found]
    pictures = []
    for found in (probed.found, [replace(each, movers=None) for each in probed.found]):
        sheet.save(tmp_path / "sheet.png", found, places)
        pictures.append(cv2.imread(str(tmp_path / "sheet.png")).astype(int))
    assert pictures[0].shape[1] == 1400
    marked = np.abs(pictures[0] - pictures[1]).max(axis=2) > 50
    assert [bool(part.sum() > 50) for part in np.array_split(marked, 4, axis=1)] == [True] * 4  # pixels
