"""Clip-parallel work on any `concurrent.futures.Executor`, results in the order of the inputs."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from physpipe.core.progress import progress

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_parallel(
    work: Callable[[Item], Result], items: Sequence[Item], what: str, executor: Executor | None = None
) -> Iterator[Result]:
    """`work(item)` for every item, yielded in order whatever finishes first.

    Workers come from the environment, never from params, since they change no byte of the result:
    `PHYSPIPE_WORKERS` (default: every core; 1 = this process) or a cluster at `PHYSPIPE_DASK`.
    """
    if executor is not None:
        yield from progress(executor.map(work, items), what, total=len(items))
    elif worker_count() == 1 and "PHYSPIPE_DASK" not in os.environ:
        yield from progress(map(work, items), what, total=len(items))
    else:
        with _executor() as pool:
            yield from progress(pool.map(work, items), what, total=len(items))


def worker_count() -> int:
    """Processes to use on this machine."""
    # Linux alone tells which cores a process may use; elsewhere it may use all.
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return int(os.environ.get("PHYSPIPE_WORKERS") or cores)


@contextmanager
def _executor() -> Iterator[Executor]:
    address = os.environ.get("PHYSPIPE_DASK")
    if address:
        from dask.distributed import Client  # optional extra `cluster`

        with Client(address) as client:
            yield client.get_executor(pure=False)
    else:  # spawn: the one start method that every platform has and that no library's threads break
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(worker_count(), mp_context=context) as pool:
            yield pool
