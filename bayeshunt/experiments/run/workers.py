"""Workers: the same call on many items, here, on other processes, or on other machines.

joblib does the work: loky processes on this machine, or a dask cluster. A worker that is killed
costs what it had in hand, which is run again.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from bayeshunt.core.errors import BayesHuntError, InputError, WorkerError

__all__ = [
    "LOCAL",
    "Item",
    "Output",
    "check_jobs",
    "check_scheduler",
    "check_worker_versions",
    "guard_worker",
    "parallel",
    "stand_in",
    "work_off",
]

Item = TypeVar("Item")
Output = TypeVar("Output")

#: A cluster of worker processes started on this machine for the time of the work.
LOCAL = "local"
_PATIENCE = 10  # seconds to wait for a scheduler's answer
_FRUITLESS = 3  # pools that may die in a row without finishing anything


def check_jobs(jobs: int) -> None:
    """Raise InputError unless ``jobs`` is a positive whole number or -1."""
    if isinstance(jobs, bool) or not isinstance(jobs, (int, np.integer)) or not (jobs >= 1 or jobs == -1):
        raise InputError(f"jobs: expected a whole number of at least 1, or -1 for one per core, got {jobs!r}")


def check_scheduler(scheduler: str | None) -> None:
    """Raise InputError unless ``scheduler`` is None, "local" or an address, and dask is installed if need be."""
    if scheduler is None:
        return
    if scheduler != LOCAL and "://" not in scheduler:
        raise InputError(f"scheduler {scheduler!r}: expected {LOCAL} or an address such as tcp://192.168.0.10:8786")
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise InputError("a scheduler needs dask: pip install '.[distributed]' in bayeshunt's folder") from None


def work_off(
    missing: Callable[[], Sequence[Item]], run: Callable[[Sequence[Item]], Iterator[Output]]
) -> Iterator[Output]:
    """Yield what ``run`` makes of everything in ``missing()``, again and again until nothing is missing.

    A killed worker ends ``run``; the loop asks what is missing now and goes on with that. The caller
    takes note of each output before asking for the next. Raises WorkerError if workers die three
    times in a row without anything getting done.
    """
    fruitless = 0
    while todo := missing():
        try:
            yield from run(todo)
            return
        except Exception as error:
            if not _is_lost_worker(error):
                raise
            fruitless = fruitless + 1 if len(missing()) == len(todo) else 0
            if fruitless == _FRUITLESS:
                raise WorkerError(
                    f"workers were killed {_FRUITLESS} times in a row without finishing anything "
                    f"({type(error).__name__}); is there enough memory? try fewer --jobs"
                ) from None


def parallel(
    call: Callable[[Item], Output],
    items: Iterable[Item],
    *,
    jobs: int = 1,
    scheduler: str | None = None,
) -> Iterator[Output]:
    """Yield ``call(item)`` of every item, in any order.

    jobs: processes on this machine; 1 works here and now, -1 is one per core. scheduler: None,
    "local" (a dask cluster of ``jobs`` processes for the time of the work) or the address of a dask
    scheduler, whose workers then do everything.
    """
    if scheduler is None and jobs == 1:
        yield from map(call, items)
        return
    from joblib import Parallel, delayed

    with _backend(jobs, scheduler) as options:
        pool = Parallel(**options, return_as="generator_unordered", pre_dispatch="2*n_jobs", batch_size=1)
        with _interrupts_held_back():
            outputs = pool(delayed(call)(item) for item in items)
        try:
            for output in outputs:  # noqa: UP028 - "yield from" would close it itself, aloud
                yield output
        finally:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # joblib says how many calls were cancelled: that was the wish
                outputs.close()  # also stops workers when the caller has had enough


@contextlib.contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Keep Ctrl-C waiting while worker processes start: they inherit the block, and leave it to the parent."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _backend(jobs: int, scheduler: str | None) -> Iterator[dict[str, Any]]:
    """Yield joblib's options for the workers asked for."""
    if scheduler is None:
        yield {"n_jobs": jobs, "backend": "loky"}
        return
    from distributed import Client
    from joblib import parallel_config

    with contextlib.ExitStack() as stack:
        address = scheduler if scheduler != LOCAL else stack.enter_context(_local_cluster(jobs))
        try:
            client = stack.enter_context(Client(address, timeout=_PATIENCE, set_as_default=False))  # type: ignore[no-untyped-call]
        except (OSError, ValueError) as error:
            reason = (str(error).splitlines() or [type(error).__name__])[0]
            raise InputError(f"scheduler {scheduler}: no dask scheduler answers there ({reason})") from None
        stack.enter_context(parallel_config(backend="dask", client=client))
        yield {"n_jobs": -1}


def _local_cluster(jobs: int) -> Any:
    from distributed import LocalCluster

    count = jobs if jobs > 0 else os.cpu_count() or 1
    return LocalCluster(n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None)  # type: ignore[no-untyped-call]


def _is_lost_worker(error: BaseException) -> bool:
    """Whether an exception says that a worker process died."""
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    lost: tuple[type[BaseException], ...] = (TerminatedWorkerError,)
    with contextlib.suppress(ImportError):
        from distributed.scheduler import KilledWorker

        lost = (*lost, KilledWorker)
    return isinstance(error, lost)


_guarded = False


def guard_worker(parent: int) -> None:
    """In a worker process: end when the parent has died.

    parent: process id of the one who started the work. Does nothing in that process itself.
    """
    global _guarded
    if _guarded or os.getpid() == parent or os.getppid() != parent:
        return
    _guarded = True
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def stand_in(folder: str, parent: int) -> None:
    """In a worker process of ``parent``: stand where it stands, so that relative names mean the same files.

    A pool is used again by later work, whose folder may be another one. Does nothing in that process itself, nor in
    one of another machine or of somebody else's.
    """
    if os.getppid() == parent and Path(folder).is_dir():
        os.chdir(folder)


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def check_worker_versions(expected: dict[str, str], found: dict[str, str]) -> None:
    """Raise BayesHuntError if this worker's libraries are not those of the process that asks."""
    for name, wanted in expected.items():
        if found.get(name) != wanted:
            raise BayesHuntError(
                f"a worker has {name} {found.get(name)}, this process {wanted}; "
                "results could differ: install the same versions on every machine"
            )
