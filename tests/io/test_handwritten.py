"""CSV files as people and their spreadsheets write them."""

from pathlib import Path

import pytest

from physpipe.core.errors import InputError
from physpipe.io import handwritten


def test_cells_are_text_and_rows_keep_the_number_of_their_line(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes('\ufeffname, n ,note\r\n x ,007,\r\n,,\r\n\r\n"y, z",NA,!\r\n'.encode())
    rows = handwritten.rows(tmp_path / "a.csv", ["name", "n"])
    assert rows.index.tolist() == [2, 5]
    assert rows.to_numpy().tolist() == [["x", "007", ""], ["y, z", "NA", "!"]]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "not a table"),
        (b"name,n\n1,2\n1,2,3\n", "not a table .*line 3"),
        (b"name,n\n\xff\xfe,2\n", "not a table"),
        (b"name;n\n1;2\n", r"lacks column\(s\) name, n.*begin it with name,n"),
    ],
)
def test_what_is_no_such_table_is_refused_by_name(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=said) as caught:
        handwritten.rows(tmp_path / "a.csv", ["name", "n"])
    assert caught.value.where == str(tmp_path / "a.csv")
