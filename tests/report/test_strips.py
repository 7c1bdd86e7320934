"""Every frame is found again in the pictures that hold many."""

import base64

import cv2
import numpy as np
import pytest

from physpipe.report import strips
from physpipe.report.strips import strip


def film(T: int, H: int, W: int) -> np.ndarray:
    """Smooth frames, each of a grey of its own with a bright corner."""
    frames = np.zeros((T, H, W, 3), np.uint8)
    frames[:] = (40 + 6 * np.arange(T, dtype=np.uint8))[:, None, None, None]
    frames[:, :4, :6, 0] = 250
    return frames


def cells(made: dict) -> list[np.ndarray]:
    """All cells of all pictures, as the page's script cuts them out."""
    width, height = made["cell"]
    found = []
    for picture in made["pictures"]:
        raw = base64.b64decode(picture.removeprefix("data:image/webp;base64,"), validate=True)
        whole = cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
        assert whole.shape[1] == made["columns"] * width
        rows = whole.shape[0] // height
        found += [
            whole[row * height : (row + 1) * height, column * width : (column + 1) * width]
            for row in range(rows)
            for column in range(made["columns"])
        ][: made["each"]]
    return found


@pytest.mark.parametrize("size", [(32, 48), (21, 33), (40, 17)])
@pytest.mark.parametrize("T", [1, 7])
def test_frames_stand_in_their_cells(T, size):
    frames = film(T, *size)
    made = strip(frames, 95)
    assert len(made["pictures"]) == 1
    for frame, cell in zip(frames, cells(made), strict=False):
        away = np.abs(cell[: size[0], : size[1]].astype(int) - frame)
        assert np.median(away) <= 2  # grey levels: the codec rounds
        assert np.abs(cell[6:, 8:].mean() - frame[6:, 8:].mean()) < 3  # neighbours, 6 levels away, do not bleed


def test_a_long_clip_takes_several_pictures_of_bounded_size(monkeypatch):
    monkeypatch.setattr(strips, "PICTURE_PX", 5 * 32 * 48)
    frames = film(13, 32, 48)
    made = strip(frames, 95)
    assert (made["each"], len(made["pictures"])) == (5, 3)
    greys = [cell[10:, 10:].mean() for cell in cells(made)[:13]]
    np.testing.assert_allclose(greys, frames[:, 10:, 10:].mean(axis=(1, 2, 3)), atol=2)  # grey levels


def test_a_frame_larger_than_the_bound_is_still_shown(monkeypatch):
    monkeypatch.setattr(strips, "PICTURE_PX", 10)
    assert len(strip(film(3, 32, 48), 80)["pictures"]) == 3
