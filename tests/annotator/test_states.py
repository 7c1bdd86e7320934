"""What is said about a clip: the same there and back, and named by what it says."""

import pytest
from pydantic import ValidationError

from physpipe.annotator import states
from physpipe.annotator.states import BoxRow, ClipState, CorrectionRow
from physpipe.io import annotations

BOXES = (BoxRow(object=0, frame=3, x=1, y=2.5, w=9, h=11),)
CORRECTIONS = (
    CorrectionRow(object=0, frame=4, x=10.25, y=11, visible=True, interpolated=False),
    CorrectionRow(object=0, frame=5, x=11.123456789, y=11.5, visible=True, interpolated=True),
    CorrectionRow(object=0, frame=6, x=12, y=12, visible=False, interpolated=False),
    CorrectionRow(object=1, frame=0, x=None, y=None, visible=False, interpolated=False),
)
STATE = ClipState(boxes=BOXES, corrections=CORRECTIONS)


def test_rows_are_text_and_come_back_through_the_reader(clips, annotate_files):
    folder = annotate_files()
    for name in ("templates.csv", "corrections.csv"):
        STATE.table(name, "b").to_csv(folder / name, index=False)
    assert (folder / "corrections.csv").read_text().splitlines()[1:] == [
        "b,0,4,10.25,11,true,false",
        "b,0,5,11.1235,11.5,true,true",
        "b,0,6,12,12,false,false",
        "b,1,0,,,false,false",
    ]
    back = states.of_clip(annotations.load(folder, clips), "b")
    assert back.boxes == BOXES
    assert back.corrections[1].x == pytest.approx(11.1235, abs=1e-9)  # pixels; six digits are written
    assert [row for row in back.corrections if row.frame != 5] == [row for row in CORRECTIONS if row.frame != 5]
    assert states.of_clip(annotations.load(folder, clips), "a") == ClipState(boxes=(), corrections=())


def test_a_revision_depends_on_what_is_said_and_not_on_its_order():
    reordered = ClipState(boxes=BOXES, corrections=CORRECTIONS[::-1])
    assert reordered.revision == STATE.revision
    moved = BOXES[0].model_copy(update={"x": 1.5})
    assert ClipState(boxes=(moved,), corrections=CORRECTIONS).revision != STATE.revision


def test_rows_written_by_hand_are_keys(clips, annotate_files):
    folder = annotate_files(corrections="clip,object,frame,x,y,visible\na,0,1,3,4,yes\na,0,2,,,0\n")
    rows = states.of_clip(annotations.load(folder, clips), "a").corrections
    assert [(row.x, row.visible, row.interpolated) for row in rows] == [(3, True, False), (None, False, False)]


@pytest.mark.parametrize("change", [{"object": -1}, {"object": 1000}, {"frame": 1.5}, {"x": float("nan")}, {"z": 1}])
def test_nonsense_is_no_row(change):
    with pytest.raises(ValidationError):
        CorrectionRow.model_validate(CORRECTIONS[0].model_dump() | change)
