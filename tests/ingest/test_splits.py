"""Shares, and a set's own division."""

from collections import Counter
from pathlib import Path

import pytest
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.ingest.splits import SplitParams, Splits, drawn


def test_shares_are_met_and_depend_on_the_name_alone() -> None:
    names = [f"clip_{number:04d}_00" for number in range(4000)]
    shares = SplitParams(valid=0.15, test=0.2)
    splits = [drawn(name, shares) for name in names]
    assert splits.count("valid") / 4000 == pytest.approx(0.15, abs=0.02)  # three standard deviations
    assert splits.count("test") / 4000 == pytest.approx(0.2, abs=0.02)
    assert [drawn(name, shares) for name in names[::-1]] == splits[::-1]
    with pytest.raises(ValidationError):
        SplitParams(valid=0.6, test=0.6)


def test_names_decide_whatever_the_shares_say() -> None:
    splits = Splits(SplitParams(valid=0.0, test=1.0), {"a.mp4": "train", "b.mp4": "valid"})
    assert {splits.of("a.mp4", f"a_{part:02d}") for part in range(50)} == {"train"}
    assert splits.of("b.mp4", "b_00") == "valid"


def test_an_empty_split_of_a_split_file_is_mended_there(tmp_path: Path) -> None:
    counts: Counter = Counter(train=3, test=2)
    with pytest.raises(InputError, match=r"`valid` \(train 3, valid 0, test 2\).*in splits.csv"):
        Splits(SplitParams(valid=0.1, test=0.1), {}).refuse_empty(tmp_path, counts)
    Splits(SplitParams(valid=0.0, test=0.1), {}).refuse_empty(tmp_path, counts)
