"""Results come in the order of the inputs, whoever does the work."""

import pickle
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from physpipe.core.errors import DiskFullError, InputError
from physpipe.core.parallel import in_parallel, worker_count


def slow_first(item: int) -> int:
    """The square; small items take longest."""
    time.sleep(0.02 * (3 - item))
    return item * item


def refuse(item: str) -> str:
    raise (DiskFullError if item == "disk" else InputError)(item, "bad", "mend it")


def test_the_order_is_that_of_the_inputs_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "1")
    assert list(in_parallel(slow_first, range(4), "squares")) == [0, 1, 4, 9]


def test_the_order_is_that_of_the_inputs_on_any_executor() -> None:
    with ThreadPoolExecutor(4) as executor:
        assert list(in_parallel(slow_first, range(4), "squares", executor)) == [0, 1, 4, 9]


def test_a_process_pool_gives_the_same_and_carries_errors_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "2")
    monkeypatch.delenv("PHYSPIPE_DASK", raising=False)
    assert list(in_parallel(abs, [-2, 3, -1], "absolute values")) == [2, 3, 1]


@pytest.mark.parametrize("kind", [InputError, DiskFullError])
def test_errors_cross_process_pools(kind: type[InputError]) -> None:
    error = pickle.loads(pickle.dumps(kind("a.mp4", "bad", "mend it")))
    assert type(error) is kind
    assert str(error) == "a.mp4: bad. To mend: mend it."


def test_an_error_in_the_work_is_raised() -> None:
    with ThreadPoolExecutor(2) as executor, pytest.raises(DiskFullError):
        list(in_parallel(refuse, ["disk"], "errors", executor))


def test_the_number_of_workers_comes_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PHYSPIPE_WORKERS", "3")
    assert worker_count() == 3
    monkeypatch.delenv("PHYSPIPE_WORKERS")
    assert worker_count() >= 1
