"""Where runs are computed: in this process, in processes on all cores, or on a Dask cluster."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from swarm.errors import RunFailedError, UserError
from swarm.extras import require_extra
from swarm.interpreter import safe_path

SCHEDULERS = ("processes", "dask")
LEAVE_WITHIN_S = 10.0
"""To put in order what a worker has, such as the processes of a trial, takes 5 s at most."""


def available_cores() -> list[int]:
    """The cores that this process may use; all of the machine where the system does not say."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


@dataclass(frozen=True)
class Workers:
    """`count` calls are computed at a time; `each` yields the results of calls as they come in."""

    count: int
    each: Callable[[Callable[..., Any], Iterable[tuple[Any, ...]]], Iterator[Any]]


@contextmanager
def workers(scheduler: str, jobs: int) -> Iterator[Workers]:
    """`jobs` workers of a scheduler: "processes", "dask" (a cluster on this machine, loopback only), or
    the address of a running Dask scheduler, such as tcp://10.0.0.5:8786, whose workers have this package.
    """
    if scheduler == "processes":
        if jobs == 1:
            yield Workers(1, _in_this_process)
            return
        try:
            with safe_path(), _processes(jobs) as pool:
                yield Workers(jobs, _through(pool))
        except BrokenExecutor as error:
            raise RunFailedError(
                "a worker process died (out of memory?); what was finished is kept: start again, "
                "perhaps with fewer --jobs"
            ) from error
    else:
        with safe_path(), _dask(scheduler, jobs) as dask_workers:
            yield dask_workers


def check_scheduler(scheduler: str) -> None:
    """UserError unless `workers` knows the scheduler, or it is an address."""
    if scheduler not in SCHEDULERS and "://" not in scheduler:
        known = ", ".join(SCHEDULERS)
        raise UserError(f"unknown scheduler {scheduler!r}; known: {known} or an address like tcp://HOST:8786")


def _in_this_process(call: Callable[..., Any], arguments: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
    return (call(*one) for one in arguments)


def _through(pool: Executor) -> Callable[[Callable[..., Any], Iterable[tuple[Any, ...]]], Iterator[Any]]:
    def each(call: Callable[..., Any], arguments: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
        # A finished result must not be held once it was yielded: there may be thousands.
        for future in as_completed({pool.submit(call, *one) for one in arguments}):
            yield future.result()

    return each


@contextmanager
def _processes(jobs: int) -> Iterator[Executor]:
    # Threads of polars do not survive a fork, so that workers are started afresh.
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), initializer=_obey_parent)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _obey_parent() -> None:
    """Ctrl-C reaches all processes of a terminal; the parent is the one that answers it. When the parent is
    gone, killed perhaps, nobody waits for a result: its workers leave too.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_await_parents_end, daemon=True).start()


def _await_parents_end() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        threading.Event().wait(LEAVE_WITHIN_S)
        os._exit(1)


@contextmanager
def _dask(scheduler: str, jobs: int) -> Iterator[Workers]:
    require_extra("cluster", "dask", "distributed")
    with _dask_client(scheduler, jobs) as client:
        count = max(1, sum(client.nthreads().values()))
        yield Workers(count, _through(client.get_executor(pure=False)))


@contextmanager
def _dask_client(scheduler: str, jobs: int) -> Iterator[Any]:
    distributed: Any = importlib.import_module("distributed")
    if scheduler == "dask":
        settings = {"n_workers": jobs, "threads_per_worker": 1, "host": "127.0.0.1"}
        with (
            distributed.LocalCluster(**settings, dashboard_address=None) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield client
        return
    try:
        client = distributed.Client(scheduler, timeout="10s")
    except OSError as error:
        raise UserError(f"no Dask scheduler answers at {scheduler}: {error}") from error
    with client:
        yield client
