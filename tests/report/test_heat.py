"""Every column of the heat maps is shown once, under the right name."""

import base64

import cv2
import numpy as np
import pytest

from physpipe.report.heat import heat_columns

GREY = 60


def sheet(*columns: int) -> bytes:
    """A PNG of columns 30 px wide, each as grey as its number says."""
    picture = np.concatenate([np.full((40, 30, 3), GREY * each, np.uint8) for each in columns], axis=1)
    return cv2.imencode(".png", picture)[1].tobytes()


def shown(picture: str) -> int:
    """The number of the column that the picture is."""
    raw = base64.b64decode(picture.removeprefix("data:image/webp;base64,"))
    decoded = cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR)
    assert decoded.shape == (40, 30, 3)
    return round(decoded.mean() / GREY)


@pytest.mark.parametrize(
    ("first", "every", "detectors", "expected"),
    [
        ((0, 1, 2, 3), (0, 3), 1, {"film": 0, "start 0": 1, "start 1": 2, "in the end": 3}),
        ((0, 1, 2), (0, 2), 1, {"film": 0, "start 0": 1, "in the end": 2}),
        (
            (0, 1, 2),
            (0, 2, 3, 4),
            3,
            {"film": 0, "start 0": 1, "object 0, in the end": 2, "object 1, in the end": 3, "object 2, in the end": 4},
        ),
    ],
)
def test_columns_have_their_names_and_none_is_there_twice(first, every, detectors, expected):
    columns = heat_columns([sheet(*first), sheet(*every)], detectors)
    assert {each.label: shown(each.picture) for each in columns} == expected
    assert len(columns) == len(expected)


def test_without_both_sheets_there_is_nothing_to_show():
    assert heat_columns([sheet(0, 1, 2)], 1) == []
    assert heat_columns([], 1) == []
