import numpy as np
import pandas as pd
import pytest

from physpipe.core.errors import InputError
from physpipe.io import forecasts, tables

N, OBJECTS, FIRST = 5, 2, 4


def some(cov: bool) -> pd.DataFrame:
    """Two clips."""
    generator = np.random.default_rng(0)
    tables = []
    for clip in ("b", "a"):
        mean = generator.normal(50, 20, (N, OBJECTS, 2)).astype(np.float32)
        spread = np.broadcast_to(np.array([[4.0, 1.0], [1.0, 2.0]]), (N, OBJECTS, 2, 2)) if cov else None
        tables.append(forecasts.rows(clip, FIRST, mean, spread))
    return pd.concat(tables)


@pytest.mark.parametrize("cov", [False, True])
def test_what_is_saved_comes_back(tmp_path, cov):
    path, table = tmp_path / "set" / "net.parquet", some(cov)
    forecasts.save(path, table, "net", seen_frames=4, horizon=3)
    back = forecasts.load(path)
    pd.testing.assert_frame_equal(back, table.sort_values(forecasts.KEY, ignore_index=True))
    assert tables.metadata(path) == {"version": 1, "producer": "net", "seen_frames": 4, "horizon": 3}


def test_a_clips_arrays_are_those_it_was_made_of():
    mean = np.arange(N * OBJECTS * 2, dtype=np.float32).reshape(N, OBJECTS, 2)
    cov = np.array([[3.0, -1.0], [-1.0, 2.0]]) * np.arange(1, N + 1)[:, None, None, None]
    cov = np.repeat(cov, OBJECTS, axis=1)
    found = forecasts.by_clip(forecasts.rows("a", FIRST, mean, cov))["a"]
    assert found.first == FIRST
    np.testing.assert_array_equal(found.mean, mean)
    np.testing.assert_array_equal(found.cov, cov)


def test_a_table_without_rows_can_be_saved(tmp_path):
    forecasts.save(tmp_path / "none.parquet", forecasts.empty(), "net", 4, 3)
    assert forecasts.by_clip(forecasts.load(tmp_path / "none.parquet")) == {}


def spoilt(how: str) -> pd.DataFrame:
    table = some(cov=True).reset_index(drop=True)
    if how == "repeats":
        return pd.concat([table, table.iloc[:1]])
    if how == "lacks rows":
        return table.drop(index=2)
    if how == "finite":
        table.loc[3, "x"] = np.inf
    if how == "covariance":
        table.loc[3, "cov_xy"] = 3.0  # correlation beyond 1
    return table


@pytest.mark.parametrize("how", ["repeats", "lacks rows", "finite", "covariance"])
def test_bad_rows_are_refused_and_nothing_is_written(tmp_path, how):
    with pytest.raises(InputError, match=how):
        forecasts.save(tmp_path / "net.parquet", spoilt(how), "net", 4, 3)
    assert list(tmp_path.iterdir()) == []


def test_other_files_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        forecasts.load(tmp_path / "net.parquet")
    some(cov=False).drop(columns="x").to_parquet(tmp_path / "other.parquet")
    with pytest.raises(InputError, match="lacks"):
        forecasts.load(tmp_path / "other.parquet")
