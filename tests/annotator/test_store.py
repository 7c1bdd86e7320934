"""The files that the page writes: other rows untouched, nothing written that the reader refuses, no change lost."""

from pathlib import Path

import pytest

from physpipe.annotator import states
from physpipe.annotator.states import BoxRow, ClipState, CorrectionRow
from physpipe.annotator.store import StaleError, Store
from physpipe.core.errors import InputError

EMPTY = ClipState(boxes=(), corrections=())


def key(frame: int, x: float = 20, obj: int = 0, interpolated: bool = False) -> CorrectionRow:
    return CorrectionRow(object=obj, frame=frame, x=x, y=10, visible=True, interpolated=interpolated)


def saying(*corrections: CorrectionRow, boxes: tuple[BoxRow, ...] = ()) -> ClipState:
    return ClipState(boxes=boxes, corrections=corrections)


@pytest.fixture
def store(clips, annotate_files) -> Store:
    return Store(annotate_files(), clips)


def texts(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_a_set_that_nobody_annotated_gets_its_files_with_the_first_change(store):
    store.folder.rmdir()
    box = BoxRow(object=1, frame=0, x=3, y=4, w=9, h=9)
    after = store.save("a", saying(boxes=(box,)), EMPTY.revision)
    assert after.boxes == (box,)
    assert texts(store.folder) == {"templates.csv": "clip,object,frame,x,y,w,h\na,1,0,3,4,9,9\n"}


def test_only_the_clips_own_rows_change(store, annotate_files):
    before = "clip,note,object,frame,x,y,visible\nb,see film,0,07,3.50,4,yes\n\na,gone,01,2,1,1,true\na,,1,10,2,2,no\n"
    annotate_files(corrections=before)
    now = states.of_clip(store.read(), "a")
    store.save("a", saying(*now.corrections[:1], key(3, obj=1), key(0)), now.revision)
    assert texts(store.folder) == {
        "corrections.csv": "clip,note,object,frame,x,y,visible\n"
        "a,,0,0,20,10,true\na,gone,1,2,1,1,true\na,,1,3,20,10,true\nb,see film,0,07,3.50,4,yes\n"
    }


def test_interpolated_rows_are_told_apart_only_where_there_are_any(store):
    after = store.save("a", saying(key(1), key(2, interpolated=True), key(3)), EMPTY.revision)
    assert (store.folder / "corrections.csv").read_text() == (
        "clip,object,frame,x,y,visible,interpolated\n"
        "a,0,1,20,10,true,false\na,0,2,20,10,true,true\na,0,3,20,10,true,false\n"
    )
    store.save("b", saying(key(1)), EMPTY.revision)
    assert "b,0,1,20,10,true,false" in (store.folder / "corrections.csv").read_text()
    store.save("a", EMPTY, after.revision)
    assert texts(store.folder)["corrections.csv"].splitlines()[0] == "clip,object,frame,x,y,visible"


def test_a_change_to_a_state_that_is_no_more_is_refused_with_the_one_that_is(store):
    after = store.save("a", saying(key(1)), EMPTY.revision)
    with pytest.raises(StaleError) as caught:
        store.save("a", saying(key(2)), EMPTY.revision)
    assert caught.value.now == after
    store.save("b", saying(key(2)), EMPTY.revision)  # another clip is another matter
    store.save("a", saying(key(2)), after.revision)
    (store.folder / "corrections.csv").write_text("clip,object,frame,x,y,visible\na,0,2,20,11,true\n")  # by hand
    with pytest.raises(StaleError):
        store.save("a", saying(key(3)), saying(key(2)).revision)


@pytest.mark.parametrize(
    ("state", "said"),
    [
        (saying(key(54)), "frame beyond the clip"),
        (saying(key(1, x=64)), "position outside the frame"),
        (saying(key(1), key(1, x=3)), "repeats an earlier line"),
        (saying(boxes=(BoxRow(object=0, frame=0, x=60, y=0, w=9, h=9),)), "template outside the frame"),
    ],
)
def test_what_the_reader_would_refuse_is_not_saved(store, state, said):
    store.save("a", saying(key(5)), EMPTY.revision)
    before = texts(store.folder)
    with pytest.raises(InputError, match=said):
        store.save("a", state, saying(key(5)).revision)
    assert texts(store.folder) == before


def test_files_spoilt_by_hand_are_named_line_by_line_and_left_alone(store, annotate_files):
    annotate_files(corrections="clip,object,frame,x,y,visible\nz,0,0,1,1,true\na,0,99,1,1,true\na,0,1,1,1,perhaps\n")
    before = texts(store.folder)
    with pytest.raises(InputError) as caught:
        store.save("a", saying(key(5)), EMPTY.revision)
    for fault in ("no such clip: line 2", "frame beyond the clip: line 3", "`visible` is not true or false: line 4"):
        assert fault in str(caught.value)
    assert texts(store.folder) == before


def test_a_kill_in_the_middle_of_writing_leaves_the_old_file(store, monkeypatch):
    after = store.save("a", saying(key(5)), EMPTY.revision)
    before, rename = texts(store.folder), Path.replace

    def killed(temporary: Path, target: Path) -> None:
        if target.parent == store.folder:
            raise KeyboardInterrupt
        rename(temporary, target)

    monkeypatch.setattr(Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        store.save("a", saying(key(6)), after.revision)
    assert texts(store.folder) == before


def test_a_folder_that_cannot_be_written_is_named(store):
    store.folder.rmdir()
    store.folder.parent.rmdir()
    store.folder.parent.write_text("a file where the folder should be")
    with pytest.raises(InputError, match=r"corrections.csv: cannot be written .* make the folder writable"):
        store.save("a", saying(key(6)), EMPTY.revision)
