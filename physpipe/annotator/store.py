"""The two tables that the page writes: read anew at every request, changed clip by clip, whole or not at all."""

import tempfile
from pathlib import Path
from threading import Lock

import pandas as pd

from physpipe.annotator import states
from physpipe.annotator.states import INTERPOLATED, ClipState
from physpipe.core.errors import DiskFullError, InputError
from physpipe.io import annotations, handwritten, results, tracks
from physpipe.io.annotations import COLUMNS, CORRECTIONS, TEMPLATES, Annotations
from physpipe.io.clips import ClipSet

TABLES = (TEMPLATES, CORRECTIONS)


class StaleError(Exception):
    """The clip's annotations are no longer those that a change began with: another tab or an editor changed them."""

    def __init__(self, now: ClipState):
        self.now = now
        super().__init__("this clip was changed elsewhere: in another tab, or in the files by hand")


class Store:
    """The annotations of one data set on disk; the files are the only memory, so that they may be edited by hand."""

    def __init__(self, folder: Path, clips: ClipSet):
        self.folder, self.clips = folder, clips
        self._writing = Lock()

    def read(self) -> Annotations:
        """Everything that was given; raises InputError naming every bad line of a file."""
        return annotations.load(self.folder, self.clips)

    def checked(self, clip: str, state: ClipState) -> Annotations:
        """`state` as the reader of the files understands it; raises InputError for what it would refuse."""
        return self._accepted({name: state.table(name, clip) for name in TABLES})

    def save(self, clip: str, state: ClipState, began_with: str) -> ClipState:
        """Replaces what the files say about one clip, and returns it as they now say it.

        Rows of other clips and columns that are not ours stay. `began_with` is the revision of the state that the
        change was made to. Raises StaleError when the files say something else by now, and InputError when the files
        or the state are faulty or cannot be written; nothing is written then.
        """
        with self._writing:
            before = states.of_clip(self.read(), clip)
            if before.revision != began_with:
                raise StaleError(before)
            tables = {name: _merged(self._words(name), clip, state.table(name, clip)) for name in TABLES}
            after = states.of_clip(self._accepted(tables), clip)
            if after.boxes != before.boxes:
                self._write(TEMPLATES, tables[TEMPLATES])
            if after.corrections != before.corrections:
                self._write(CORRECTIONS, tables[CORRECTIONS])
        return after

    def _words(self, name: str) -> pd.DataFrame:
        path = self.folder / name
        return handwritten.rows(path, COLUMNS[name]) if path.is_file() else pd.DataFrame(columns=COLUMNS[name])

    def _accepted(self, tables: dict[str, pd.DataFrame]) -> Annotations:
        """What the reader makes of the tables; the reader is the judge, so that nothing is saved that it refuses."""
        with tempfile.TemporaryDirectory() as folder:
            for name, table in tables.items():
                results.save_csv(Path(folder) / name, table)
            return annotations.load(Path(folder), self.clips)

    def _write(self, name: str, table: pd.DataFrame) -> None:
        path = self.folder / name
        try:
            results.save_csv(path, table)
        except DiskFullError:
            raise
        except OSError as error:
            raise InputError(path, f"cannot be written ({error.strerror})", "make the folder writable") from None


def _merged(words: pd.DataFrame, clip: str, rows: pd.DataFrame) -> pd.DataFrame:
    """The table `words` with `rows` in place of those of `clip`, in the order of clips, objects and frames."""
    mine, others = words[words["clip"] == clip], words[words["clip"] != clip]
    added = [name for name in words if name not in rows]
    notes = mine.assign(object=mine["object"].map(_plain), frame=mine["frame"].map(_plain))
    table = pd.concat([others, rows.merge(notes[[*tracks.KEY, *added]], on=tracks.KEY, how="left")]).fillna("")
    if INTERPOLATED in table and (table[INTERPOLATED] != "true").all():
        table = table.drop(columns=INTERPOLATED)
    order = pd.DataFrame({name: table[name] if name == "clip" else table[name].astype(float) for name in tracks.KEY})
    return table.iloc[order.reset_index(drop=True).sort_values(tracks.KEY, kind="stable").index]


def _plain(number: str) -> str:
    """A number as this module writes it: `02` and `2.0` are 2."""
    return str(int(float(number)))
